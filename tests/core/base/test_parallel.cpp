// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/parallel.h"

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <doctest/doctest.h>

#include "core/base/progress.h"

using namespace limber;

TEST_CASE("parallel: every item is done exactly once, whatever the grain") {
  for (std::int64_t grain : {1, 7, 1000, 5000}) {
    std::vector<int> done(1234);
    parallel_for(std::ssize(done), grain, [&](std::int64_t begin, std::int64_t end) {
      for (auto i = begin; i < end; ++i) ++done[i];
    });
    CHECK(done == std::vector<int>(1234, 1));
  }
}

TEST_CASE("parallel: a sum of rounding-sensitive terms is the same for 1, 2 and 4 threads, bit for bit") {
  auto sum = [](int threads) {
    ThreadCount limit(threads);
    return parallel_sum(100000, 512, [](std::int64_t begin, std::int64_t end) {
      double part = 0;
      for (auto i = begin; i < end; ++i) part += std::sin(double(i)) * std::pow(10.0, i % 13);
      return part;
    });
  };
  const double one = sum(1);
  CHECK(one == sum(2));
  CHECK(one == sum(4));
}

TEST_CASE("parallel: what a block throws reaches the caller") {
  CHECK_THROWS_AS(parallel_for(100, 1,
                               [](std::int64_t begin, std::int64_t) {
                                 if (begin == 57) throw std::runtime_error("57");
                               }),
                  std::runtime_error);
}

TEST_CASE("parallel: loops under a cancelled progress stop before their next block, others run on") {
  Progress& quiet = no_progress();
  struct Cancellable : Progress {
  } progress;
  int done = 0;
  {
    ThreadCount one(1);
    CancelScope scope(progress);
    CHECK_THROWS_AS(parallel_for(100, 1,
                                 [&](std::int64_t begin, std::int64_t) {
                                   ++done;
                                   if (begin == 9) progress.cancel();
                                 }),
                    Cancelled);
    CHECK(done == 10);
    CHECK_THROWS_AS(parallel_for(1, 1, [&](std::int64_t, std::int64_t) { ++done; }), Cancelled);
    CancelScope inner(quiet);
    parallel_for(5, 1, [&](std::int64_t, std::int64_t) { ++done; });
  }
  parallel_for(5, 5, [&](std::int64_t begin, std::int64_t end) { done += int(end - begin); });
  CHECK(done == 20);
}
