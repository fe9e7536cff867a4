// SPDX-License-Identifier: AGPL-3.0-or-later
// Work that may take its time, beside threads that may not: those that draw.
#pragma once

#include <functional>

namespace limber {

// Runs `work` and waits for it: on a thread of its own that yields to all others of usual priority, and that is all it
// takes, since loops within (parallel.h) take no further thread unless a ThreadCount lives. What is thrown comes out
// here.
void in_background(const std::function<void()>& work);

}  // namespace limber
