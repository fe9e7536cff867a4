// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs loops on several threads with results that do not depend on the number of threads. The range of a loop is cut
// into fixed blocks of `grain` elements, and one thread processes a block from front to back. A block writes only its
// own part of an output or its own partial sum, so the result is the same for 1 and for 64 threads.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

namespace limber {

class Progress;

// Calls body(begin, end) for every block of at most `grain` elements of [0, count). If a block throws, its exception is
// rethrown here after all running blocks have ended.
void parallel_for(std::int64_t count, std::int64_t grain, const std::function<void(std::int64_t, std::int64_t)>& body);

// Returns the sum of body(begin, end) over all blocks of [0, count), added in the order of the blocks.
double parallel_sum(std::int64_t count, std::int64_t grain,
                    const std::function<double(std::int64_t, std::int64_t)>& body);

// While a ThreadCount is alive, parallel loops use `threads` threads (1 or more; may exceed the number of cores).
// Otherwise they use every core. A program's main or a test creates a ThreadCount.
class ThreadCount {
 public:
  explicit ThreadCount(int threads);
  ~ThreadCount();
  ThreadCount(const ThreadCount&) = delete;
  ThreadCount& operator=(const ThreadCount&) = delete;

 private:
  struct Limit;
  std::unique_ptr<Limit> limit_;
};

// While a CancelScope is alive, the parallel loops that this thread starts check whether `progress` is cancelled. If
// so, each loop stops before its next block and throws Cancelled. A command or a job creates a CancelScope around its
// work, so that no step has to check between its own loops.
class CancelScope {
 public:
  explicit CancelScope(const Progress& progress);
  ~CancelScope();
  CancelScope(const CancelScope&) = delete;
  CancelScope& operator=(const CancelScope&) = delete;

 private:
  const Progress* previous_;
};

}  // namespace limber
