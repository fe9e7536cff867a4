// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/background.h"

#include <future>

#include <sys/resource.h>

#include <tbb/task_arena.h>

namespace limber {

namespace {
constexpr int kYielding = 10;  // of 0 to 19: a tenth of what an unyielding thread on the same core gets
}  // namespace

void in_background(const std::function<void()>& work) {
  std::async(std::launch::async, [&work] {
    // Of this thread alone, on Linux. Where it is not allowed the work is done all the same.
    setpriority(PRIO_PROCESS, 0, kYielding);
    tbb::task_arena alone(1);
    alone.execute(work);
  }).get();
}

}  // namespace limber
