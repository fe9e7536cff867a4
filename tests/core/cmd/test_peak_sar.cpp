// SPDX-License-Identifier: AGPL-3.0-or-later
// SAR over cubes of 10 g (assets/examples/peak_sar.py) against a slow program that was written on its own
// (tests/support/peak_sar_slow.py), on bodies made by hand and at random.
#include <doctest/doctest.h>

#include "tests/support/program.h"

using namespace limber::test;

TEST_CASE("peak SAR: every cell's cube, that of cells in no valid cube too, is the one that plain loops over all cells and all six sides find") {
  if (run_program("/usr/bin/python3", {"-c", "import numpy"}).exit_code != 0) {
    MESSAGE("SKIPPED: python's numpy is not installed");
    return;
  }
  const auto run = run_program("/usr/bin/python3", {LIMBER_SOURCE_DIR "/tests/support/peak_sar_slow.py", LIMBER_SOURCE_DIR "/assets/examples", "6"});
  INFO(run.out, run.err);
  CHECK(run.exit_code == 0);
  CHECK(run.out == "same\n");
}
