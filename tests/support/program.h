// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs the `limber` program as a user would and keeps what it printed, its exit code and what it cost.
// A test that compares with another program starts with NEEDS_PROGRAM("blender"), which skips it, loudly, where that is
// not on PATH.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace limber::test {

struct ProgramRun {
  int exit_code = -1;  // 128 + signal when a signal ended it
  std::string out, err;
  double cpu_seconds = 0;  // user + system, from the operating system
  double wall_seconds = 0;
  double peak_mb = 0;
};

// `program` defaults to the limber that was built beside the tests.
ProgramRun run_limber(const std::vector<std::string>& arguments);
ProgramRun run_program(const std::string& program,
                       const std::vector<std::string>& arguments);  // a path, or a name on PATH

bool has_program(const std::string& name);  // on PATH

// A folder that is empty at the start and gone at the end.
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
