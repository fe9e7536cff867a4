// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the real volumes, rigs and motions that are not part of the project, in the folder named by LIMBER_SHARED. A
// test that needs such a file starts with NEEDS_SHARED("data/bender/man-arm-2mm.mha"). If the file is missing, the test
// is skipped with a message.
#pragma once

#include <cstdlib>
#include <filesystem>

#include <doctest/doctest.h>

namespace limber::test {

inline std::filesystem::path shared_path(const std::filesystem::path& relative) {
  const char* set = std::getenv("LIMBER_SHARED");
  return std::filesystem::path(set ? set : LIMBER_SOURCE_DIR "/../shared") / relative;
}

}  // namespace limber::test

#define NEEDS_SHARED(relative)                                                          \
  if (!std::filesystem::exists(limber::test::shared_path(relative))) {                  \
    MESSAGE("SKIPPED: ", limber::test::shared_path(relative).string(), " is not here"); \
    return;                                                                             \
  }
