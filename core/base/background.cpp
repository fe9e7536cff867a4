// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/background.h"

#include <future>

#include <sys/resource.h>

#include <tbb/task_arena.h>

namespace limber {

namespace {
// Nice value of a background thread (0: normal, 19: lowest priority). At 10, the thread gets a tenth of the time of a
// normal thread on the same core.
constexpr int kYielding = 10;
}  // namespace

void in_background(const std::function<void()>& work) {
  std::async(std::launch::async, [&work] {
    // On Linux, setpriority() with 0 sets the priority of the calling thread only. If it fails, the work runs at normal
    // priority.
    setpriority(PRIO_PROCESS, 0, kYielding);
    tbb::task_arena alone(1);
    alone.execute(work);
  }).get();
}

}  // namespace limber
