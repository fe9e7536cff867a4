// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/gl/shader_source.h"

#include <algorithm>
#include <stdexcept>

namespace limber::render::gl {

namespace {

std::string_view text_of(std::string_view name) {
  const auto& files = shader_files();
  const auto has_name = [&](const ShaderFile& file) { return file.name == name; };
  const auto found = std::find_if(files.begin(), files.end(), has_name);
  if (found == files.end()) throw std::logic_error("no shader is called " + std::string(name));
  return found->text;
}

void append_file(std::string& source, std::string_view name) {
  constexpr std::string_view kInclude = "#include \"";
  std::string_view text = text_of(name);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
    const std::string_view line = text.substr(0, end);
    if (line.starts_with(kInclude))
      append_file(source, line.substr(kInclude.size(), line.rfind('"') - kInclude.size()));
    else source += line;
    text.remove_prefix(end);
  }
}

}  // namespace

std::string shader_source(std::string_view file, const std::string& defines) {
  std::string source = "#version 330 core\n" + defines;
  append_file(source, file);
  return source;
}

}  // namespace limber::render::gl
