// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs long work at low priority, so that the threads that draw stay responsive.
#pragma once

#include <functional>

namespace limber {

// Runs `work` on a new thread of low priority and waits until it ends. Parallel loops (parallel.h) inside `work` also
// run on that thread alone, unless a ThreadCount is alive. An exception that `work` throws is rethrown here.
void in_background(const std::function<void()>& work);

}  // namespace limber
