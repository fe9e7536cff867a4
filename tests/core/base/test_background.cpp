// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/background.h"

#include <atomic>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include <doctest/doctest.h>
#include <sys/resource.h>

#include "core/base/parallel.h"

using namespace limber;

TEST_CASE("background: work is done when the call returns, on one thread that yields to the caller's") {
  const int usual = getpriority(PRIO_PROCESS, 0);
  std::vector<std::thread::id> done_by(1000);
  int priority = -1;
  in_background([&] {
    priority = getpriority(PRIO_PROCESS, 0);
    parallel_for(std::ssize(done_by), 1,
                 [&](std::int64_t begin, std::int64_t) { done_by[begin] = std::this_thread::get_id(); });
  });
  CHECK(std::set<std::thread::id>(done_by.begin(), done_by.end()).size() == 1);
  CHECK(done_by.front() != std::thread::id());
  CHECK(done_by.front() != std::this_thread::get_id());
  CHECK(priority > usual);
  CHECK(getpriority(PRIO_PROCESS, 0) == usual);
}

TEST_CASE("background: what the work throws comes out of the call") {
  CHECK_THROWS_AS(in_background([] { throw std::runtime_error("no"); }), std::runtime_error);
}
