// SPDX-License-Identifier: AGPL-3.0-or-later
// Loops over several threads whose results do not depend on how many threads there are.
// The range is cut into fixed blocks of `grain` items; a block is always done by one thread, front to back, so what a
// block writes (its own part of an output, its own partial sum) is the same for 1 and for 64 threads.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

namespace limber {

class Progress;

// Calls body(begin, end) for every block of at most `grain` items of [0, count). An exception thrown by any block is
// rethrown here after all running blocks have ended.
void parallel_for(std::int64_t count, std::int64_t grain, const std::function<void(std::int64_t, std::int64_t)>& body);

// Sum of body(begin, end) over all blocks, added in the order of the blocks.
double parallel_sum(std::int64_t count, std::int64_t grain,
                    const std::function<double(std::int64_t, std::int64_t)>& body);

// While it lives, parallel loops use `threads` threads (1 or more; may exceed the machine's cores). Without one they
// use every core. Made once by a program's main or by a test.
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

// While it lives, parallel loops that this thread starts stop before the next block once `progress` is cancelled, and
// throw Cancelled. Made once around a command or a job, so that no step has to ask between its own loops.
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
