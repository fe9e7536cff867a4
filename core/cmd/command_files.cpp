// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/command_files.h"

#include <cmath>
#include <cstdlib>

#include "core/base/named_files.h"
#include "core/project/journal.h"
#include "core/volume_io/volume_files.h"
#include "core/volume_io/volume_io.h"

namespace limber::cmd {

namespace {
// A CLI11 option can store named validators. The validator "files" of an option is a function that returns the files
// that the option's value names. It is inactive while options are parsed; files_of() calls it afterwards. Since a
// validator returns text, the text has for each file the letter 'r' (read) or 'w' (written), the path and a zero byte,
// which no path contains.
constexpr const char* kFiles = "files";
constexpr char kRead = 'r', kWritten = 'w';

std::string encoded(const OptionFiles& files) {
  std::string text;
  const auto add = [&](char use, const Path& path) { text.append(1, use).append(path.string()).append(1, '\0'); };
  for (const Path& path : files.read) add(kRead, path);
  for (const Path& path : files.written) add(kWritten, path);
  return text;
}

OptionFiles decoded(const std::string& text) {
  OptionFiles files;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\0', at);
    (text[at] == kRead ? files.read : files.written).emplace_back(text.substr(at + 1, end - at - 1));
    at = end + 1;
  }
  return files;
}

OptionFiles files_of(CLI::Option& option, std::string value) {
  try {
    return decoded(option.get_validator(kFiles)->active()(value));
  } catch (const CLI::OptionNotFound&) {
    std::error_code error;
    return std::filesystem::exists(value, error) ? OptionFiles{{value}, {}} : OptionFiles{};
  }
}

// Returns a file together with the files that are read when it is read, such as the journal of a project.
std::vector<Path> with_companions(const Path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return {path};
  if (path.extension() == ".limber") return {path, journal_path(std::filesystem::absolute(path))};
  return is_volume_path(path) ? files_of_volume(path) : std::vector<Path>{path};
}

// Returns true if the word is "nan", "inf" or a number too large for a double. CLI11 takes these words as numbers, and
// its range checks do not refuse "nan".
bool is_no_finite_number(const std::string& word) {
  char* end = nullptr;
  const double number = std::strtod(word.c_str(), &end);
  return end != word.c_str() && *end == '\0' && !std::isfinite(number);
}

// Throws UsageError for an option with the value "nan", "inf" or a number too large, unless the option takes text or
// the value is the name of a file.
void check_numbers(CLI::App& command) {
  std::error_code error;
  for (CLI::Option* option : command.get_options())
    for (const std::string& word : option->results())
      if (is_no_finite_number(word) && option->get_type_name() != "TEXT" && !std::filesystem::exists(word, error))
        throw UsageError("this is not a finite number", option->get_name() + " " + word,
                         "write a finite number, such as 2.5");
}
}  // namespace

CLI::Option* writes(CLI::Option* option, FilesOfValue files) {
  if (!files) files = [](const std::string& value) { return OptionFiles{{}, files_written_as(value)}; };
  const auto tell = [files](std::string& value) { return encoded(files(value)); };
  return option->check(CLI::Validator(tell, "", kFiles).active(false));
}

bool names_outputs(CLI::Option& option) {
  try {
    return option.get_validator(kFiles) != nullptr;
  } catch (const CLI::OptionNotFound&) {
    return false;
  }
}

void check_files(CLI::App& command, const Path& job) {
  check_numbers(command);
  std::vector<NamedFile> inputs, outputs;
  if (!job.empty()) inputs.push_back({"the job", job});
  for (CLI::Option* option : command.get_options()) {
    if (option->get_expected_max() == 0) continue;  // a flag, which has no value
    for (const std::string& value : option->results()) {
      const OptionFiles files = files_of(*option, value);
      const std::string name = option->get_name();
      for (const Path& path : files.read) inputs.push_back({name, path});
      for (const Path& path : files.written) outputs.push_back({name, path});
    }
  }
  if (outputs.empty()) return;
  const std::size_t named = inputs.size();
  for (std::size_t i = 0; i < named; ++i)
    for (const Path& path : with_companions(inputs[i].path)) inputs.push_back({inputs[i].named_by, path});
  check_apart(inputs, outputs);
}

void check_files_of_all(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands({}))
    command->parse_complete_callback([command] { check_files(*command); });
}

}  // namespace limber::cmd
