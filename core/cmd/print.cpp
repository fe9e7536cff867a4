// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/print.h"

#include <cstdarg>
#include <cstdio>
#include <functional>

#include "core/base/utf8.h"
#include "core/platform/terminal.h"

namespace limber::cmd {

namespace {
constexpr const char* kEraseLine = "\r\033[K";

// Returns the code of a control character, or -1 for any other character.
int control_of(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 1 && (first < 0x20 || first == 0x7f)) return first;
  if (character.size() == 2 && first == 0xc2 && static_cast<unsigned char>(character[1]) < 0xa0)
    return static_cast<unsigned char>(character[1]);
  return -1;
}

// Replaces each control character by instead(its code) and each byte that is not UTF-8 by instead(-1).
std::string cleaned(std::string_view text, const std::function<std::string(int control)>& instead) {
  std::string clean;
  clean.reserve(text.size());
  while (!text.empty()) {
    const std::size_t size = utf8_size(text);
    const int control = size == 0 ? -1 : control_of(text.substr(0, size));
    if (size == 0 || control >= 0) clean += instead(control);
    else clean += text.substr(0, size);
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return clean;
}
}  // namespace

std::string printable(std::string_view text) {
  return cleaned(text, [](int control) -> std::string {
    return control == '\n' ? "\n" : control == '\t' ? "\t" : "?";
  });
}

std::string one_line(std::string_view text) {
  return cleaned(text, [](int control) -> std::string {
    return control == '\n' || control == '\t' || control == '\r' ? " " : "?";
  });
}

void print_text(std::string_view text) {
  const std::string clean = printable(text);
  std::fwrite(clean.data(), 1, clean.size(), stdout);
}

void print(const char* format, ...) {
  va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  std::string text(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, format, arguments)), '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  va_end(arguments);
  print_text(text);
}

void print_json(std::string_view json) {
  const std::string clean = cleaned(json, [](int control) -> std::string {
    if (control == '\n') return "\n";
    char code[16];
    std::snprintf(code, sizeof code, "\\u%04x", control < 0 ? 0xfffd : control);
    return code;
  });
  std::fwrite(clean.data(), 1, clean.size(), stdout);
}

void tell(std::string_view line) {
  if (error_stream_is_terminal()) std::fputs(kEraseLine, stderr);
  std::fprintf(stderr, "%s\n", one_line(line).c_str());
}

void draw_bar(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

bool all_is_printed() { return std::fflush(stdout) == 0 && std::ferror(stdout) == 0; }

}  // namespace limber::cmd
