// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads exported files by the readers of other programs (tests/support/read_exports.py). If such a reader is not
// installed, the check is skipped with a message.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/support/program.h"

namespace limber::test {

inline ProgramRun read_export(std::vector<std::string> words) {
  if (!std::filesystem::exists("/usr/bin/python3"))
    return {.exit_code = 77, .out = "python3 is not installed", .err = {}};
  words.insert(words.begin(), LIMBER_SOURCE_DIR "/tests/support/read_exports.py");
  return run_program("/usr/bin/python3", words);
}

}  // namespace limber::test

#define READ_BACK(...)                                                                  \
  if (const auto read = limber::test::read_export({__VA_ARGS__}); read.exit_code == 77) \
    MESSAGE("SKIPPED: not read back: ", read.out);                                      \
  else CHECK_MESSAGE(read.exit_code == 0, read.out, read.err);
