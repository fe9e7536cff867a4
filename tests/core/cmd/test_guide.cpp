// SPDX-License-Identifier: AGPL-3.0-or-later
// What the user guide tells to type works as it stands.
#include <fstream>

#include <doctest/doctest.h>

#include "tests/support/program.h"

using namespace limber::test;

TEST_CASE("user guide: every point that is a command runs, one after the other, in an empty folder" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  std::ifstream guide(LIMBER_SOURCE_DIR "/assets/docs/guide.md");
  int commands = 0;
  for (std::string line; std::getline(guide, line);) {
    const std::string begin = "- `limber ";
    if (!line.starts_with(begin)) continue;
    const std::string arguments = line.substr(begin.size(), line.find('`', begin.size()) - begin.size());
    const auto run =
        run_program("/bin/sh", {"-c", "cd " + folder.path().string() + " && " LIMBER_PROGRAM " " + arguments});
    CHECK_MESSAGE(run.exit_code == 0, arguments, ": ", run.err);
    ++commands;
  }
  CHECK(commands >= 10);
}
