// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/background.h"

#include <future>

#include <tbb/task_arena.h>

#include "core/platform/process.h"

namespace limber {

void in_background(const std::function<void()>& work) {
  std::async(std::launch::async, [&work] {
    lower_priority_of_thread();
    tbb::task_arena alone(1);
    alone.execute(work);
  }).get();
}

}  // namespace limber
