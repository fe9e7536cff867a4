// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <new>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "core/base/progress.h"

namespace limber {

namespace {
// The TBB arena of the ThreadCount object that is alive; nullptr: none. The number of threads changes speed, never
// results.
std::atomic<tbb::task_arena*> current_arena = nullptr;

// The Progress of the command or job that this thread runs; nullptr: none. The thread's parallel loops check it to see
// whether the user cancelled.
thread_local const Progress* current_progress = nullptr;

// Calls `run`. If TBB cannot start a thread, throws std::bad_alloc: the usual cause is lack of memory for the thread's
// stack, and TBB reports the error only as text.
template <class Run>
void without_thread_failures(const Run& run) {
  try {
    run();
  } catch (const std::runtime_error& error) {
    if (std::string_view(error.what()).starts_with("pthread_create")) throw std::bad_alloc();
    throw;
  }
}

template <class Body>
void for_blocks(std::int64_t count, std::int64_t grain, const Body& each) {
  if (count <= 0) return;
  const auto body = [&each, progress = current_progress](std::int64_t block, std::int64_t begin, std::int64_t end) {
    if (progress && progress->cancelled()) throw Cancelled();
    each(block, begin, end);
  };
  grain = std::max<std::int64_t>(grain, 1);
  const std::int64_t blocks = (count + grain - 1) / grain;
  auto run = [&] {
    tbb::parallel_for(
        tbb::blocked_range<std::int64_t>(0, blocks, 1),
        [&](const tbb::blocked_range<std::int64_t>& range) {
          for (auto block = range.begin(); block != range.end(); ++block)
            body(block, block * grain, std::min(count, (block + 1) * grain));
        },
        tbb::simple_partitioner());
  };
  if (blocks == 1) body(std::int64_t{0}, std::int64_t{0}, count);
  else
    without_thread_failures([&] {
      if (auto* arena = current_arena.load()) arena->execute(run);
      else run();
    });
}
}  // namespace

struct ThreadCount::Limit {
  tbb::global_control control;
  tbb::task_arena arena;
  tbb::task_arena* previous;
};

ThreadCount::ThreadCount(int threads) {
  if (threads < 1) throw std::invalid_argument("ThreadCount needs at least one thread");
  limit_.reset(new Limit{tbb::global_control(tbb::global_control::max_allowed_parallelism, threads),
                         tbb::task_arena(threads), nullptr});
  limit_->previous = current_arena.exchange(&limit_->arena);
}

ThreadCount::~ThreadCount() { current_arena = limit_->previous; }

CancelScope::CancelScope(const Progress& progress) : previous_(std::exchange(current_progress, &progress)) {}
CancelScope::~CancelScope() { current_progress = previous_; }

void parallel_for(std::int64_t count, std::int64_t grain, const std::function<void(std::int64_t, std::int64_t)>& body) {
  for_blocks(count, grain, [&](std::int64_t, std::int64_t begin, std::int64_t end) { body(begin, end); });
}

double parallel_sum(std::int64_t count, std::int64_t grain,
                    const std::function<double(std::int64_t, std::int64_t)>& body) {
  if (count <= 0) return 0;
  grain = std::max<std::int64_t>(grain, 1);
  std::vector<double> part((count + grain - 1) / grain);
  for_blocks(count, grain,
             [&](std::int64_t block, std::int64_t begin, std::int64_t end) { part[block] = body(begin, end); });
  double sum = 0;
  for (double value : part) sum += value;
  return sum;
}

}  // namespace limber
