// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares SAR over cubes of 10 g (assets/examples/peak_sar.py) with a slow program that was written independently
// (tests/support/peak_sar_slow.py), on hand-made and on random bodies, and with the exact field in a ball
// (tests/support/mie_ball.py).
#include <doctest/doctest.h>

#include "tests/support/program.h"

using namespace limber::test;

namespace {

bool has_numpy() {
  if (run_program("/usr/bin/python3", {"-c", "import numpy"}).exit_code == 0) return true;
  MESSAGE("SKIPPED: python's numpy is not installed");
  return false;
}

// Runs a program that compares peak_sar.py with an independent result and prints "same".
void check_same(const std::string& program, const std::vector<std::string>& more) {
  std::vector<std::string> words{LIMBER_SOURCE_DIR "/tests/support/" + program, LIMBER_SOURCE_DIR "/assets/examples"};
  words.insert(words.end(), more.begin(), more.end());
  const auto run = run_program("/usr/bin/python3", words);
  INFO(run.out, run.err);
  CHECK(run.exit_code == 0);
  CHECK(run.out == "same\n");
}

}  // namespace

TEST_CASE(
    "peak SAR: every cell's cube, that of cells in no valid cube too, is the one that plain loops over all cells and "
    "all six sides find" *
    doctest::test_suite("slow")) {
  if (has_numpy()) check_same("peak_sar_slow.py", {"6"});
}

TEST_CASE("peak SAR: of Mie's field in a ball of muscle, cubes of 10 g in it and at its surface hold the exact SAR" *
          doctest::test_suite("slow")) {
  if (has_numpy()) check_same("mie_ball.py", {});
}
