// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs the `limber` program as a user would, and returns what it printed, its exit code, its time and its memory. A
// test that compares with another program starts with NEEDS_PROGRAM("blender"). If that program is not on PATH, the
// test is skipped with a message.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace limber::test {

struct ProgramRun {
  int exit_code = -1;  // 128 + the signal's number if a signal ended the program
  std::string out, err;
  double cpu_seconds = 0;  // user and system time, as measured by the operating system
  double wall_seconds = 0;
  double peak_mb = 0;
};

// Runs the limber program that was built together with the tests.
ProgramRun run_limber(const std::vector<std::string>& arguments);
// Runs a program, which is given as a path or as a name on PATH.
ProgramRun run_program(const std::string& program, const std::vector<std::string>& arguments);

bool has_program(const std::string& name);  // true if the program is on PATH

// A new, empty folder, which the destructor removes with its contents.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace limber::test

#define NEEDS_PROGRAM(name)                          \
  if (!limber::test::has_program(name)) {            \
    MESSAGE("SKIPPED: ", name, " is not installed"); \
    return;                                          \
  }
