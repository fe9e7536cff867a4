// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>

#include <doctest/doctest.h>

#include "tests/support/program.h"

using namespace limber::test;

TEST_CASE("command line: no subcommand, an unknown one or a missing argument is a usage error, exit 2") {
  CHECK(run_limber({"no-such-command"}).exit_code == 2);
  CHECK(run_limber({"info"}).exit_code == 2);
  CHECK(run_limber({"info", "--no-such-option", "x"}).exit_code == 2);
}

TEST_CASE("command line: help and version are no errors") {
  CHECK(run_limber({"--help"}).exit_code == 0);
  CHECK(run_limber({"--version"}).exit_code == 0);
  CHECK(run_limber({"info", "--help"}).exit_code == 0);
}

TEST_CASE("command line: a missing file is one line on stderr with what, where and what to do, exit 1") {
  const auto run = run_limber({"info", "/no/such/file.mha"});
  CHECK(run.exit_code == 1);
  CHECK(run.out.empty());
  CHECK(run.err.starts_with("limber: "));
  CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
  CHECK(run.err.find("/no/such/file.mha") != std::string::npos);
}
