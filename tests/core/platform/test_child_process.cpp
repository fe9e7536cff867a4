// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/child_process.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <thread>

#include <unistd.h>

#include <doctest/doctest.h>

#include "core/base/progress.h"
#include "tests/support/sanitizer.h"

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

TEST_CASE("child process: the reason of a failure is told" * doctest::test_suite("slow")) {
  const auto why = [](const std::function<bool(const Send&)>& work, const ChildLimits& limits = {}) {
    const ChildAnswer answer = run_in_child(work, 10, limits);
    CHECK_FALSE(answer.sent);
    return answer.failure;
  };
  CHECK(why([](const Send&) -> bool { std::abort(); }) == "the process crashed (signal 6)");
  CHECK(why([](const Send&) -> bool { std::_Exit(3); }) == "the process failed (exit code 3)");
  CHECK(why([](const Send&) { return false; }) == "the process failed (exit code 1)");
  CHECK(why([](const Send& send) { return send("01234567890", 11), true; }) == "the process sent more than expected");
  CHECK(why([](const Send&) { return ::sleep(100) == 0; }, {.seconds = 0.1}) == "the process took too long");
  // This child closes its pipe and does not end.
  CHECK(why([](const Send&) { return ::closefrom(3), ::sleep(100) == 0; }, {.seconds = 0.1}) ==
        "the process took too long");
  CHECK(why(
            [](const Send&) {
              for (volatile unsigned spins = 0;;) spins = spins + 1;
              return true;
            },
            {.processor_seconds = 1}) == "the process took too much processor time");
#ifndef LIMBER_ADDRESS_SANITIZER
  const std::size_t most = 64 << 20;
  const auto takes = [](std::size_t bytes) {
    return [bytes](const Send&) {
      void* block = std::malloc(bytes);
      if (block) std::memset(block, 1, bytes);
      return block != nullptr;
    };
  };
  CHECK(run_in_child(takes(most / 4), 10, {.memory_bytes = most}).sent);
  CHECK(why(takes(most * 2), {.memory_bytes = most}) == "the process failed (exit code 1)");
#endif
}

TEST_CASE("child process: a cancel ends the child and the wait within 100 ms") {
  using Clock = std::chrono::steady_clock;
  double waited = 1;
  // A busy machine may wake a thread late, so the test tries up to five times.
  for (int attempt = 0; attempt < 5 && waited >= 0.1; ++attempt) {
    struct : Progress {
    } progress;
    Clock::time_point asked;
    std::jthread user([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(80));
      asked = Clock::now();
      progress.cancel();
    });
    const auto cancelled = [&] { return progress.cancelled(); };
    CHECK(run_in_child([](const Send&) { return ::sleep(100) == 0; }, 10, {}, cancelled).cancelled);
    waited = std::chrono::duration<double>(Clock::now() - asked).count();
  }
  CHECK(waited < 0.1);
}
