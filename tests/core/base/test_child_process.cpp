// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/child_process.h"

#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include <doctest/doctest.h>

using namespace limber;

TEST_CASE("child process: what the work sends arrives whole, also when it is larger than a pipe") {
  const std::string long_text(3'000'000, 'x');
  const auto sent = run_in_child(
      [&](const Send& send) {
        send("abc", 3);
        send(long_text.data(), long_text.size());
        return true;
      },
      4'000'000);
  REQUIRE(sent);
  CHECK(*sent == "abc" + long_text);
}

TEST_CASE("child process: a crash, an exception, a failure or too many bytes are no result, and nothing else happens") {
  CHECK_FALSE(run_in_child([](const Send&) -> bool { std::abort(); }, 10));
  CHECK_FALSE(run_in_child([](const Send&) -> bool { return ::raise(SIGSEGV) == 0; }, 10));
  CHECK_FALSE(run_in_child([](const Send&) -> bool { throw std::runtime_error("no"); }, 10));
  CHECK_FALSE(run_in_child([](const Send&) { return false; }, 10));
  CHECK_FALSE(run_in_child(
      [](const Send& send) {
        for (int i = 0; i < 100'000; ++i) send("0123456789", 10);
        return true;
      },
      100));
  CHECK(run_in_child([](const Send&) { return true; }, 0) == "");
}
