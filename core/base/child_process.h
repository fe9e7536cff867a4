// SPDX-License-Identifier: AGPL-3.0-or-later
// Work that may crash, done where a crash does no harm: in a forked child that sends bytes back. For libraries that end
// the process on bad input.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "core/base/progress.h"

namespace limber {

using Send = std::function<void(const void* bytes, std::size_t size)>;

struct ChildLimits {
  double processor_seconds = 20;                             // of the child, in whole seconds (rounded up)
  double seconds = std::numeric_limits<double>::infinity();  // by the clock: a child may also sleep
  std::size_t memory_bytes = 0;  // beyond what this process has mapped already; 0 = no limit
};

struct ChildAnswer {
  std::optional<std::string> sent;  // nothing when it failed
  std::string failure;              // why, as in "it crashed (signal 11)"; empty when it did not
};

// What `work` sent, or nothing and the reason when it returned false, threw, crashed, ended the process, sent more than
// `most` bytes or went over a limit. The child has no standard output or error of its own, nothing it changes in memory
// is seen here, and it ends with the thread that waits for it.
//   throws Cancelled, the child gone, within some 20 ms of progress.cancel()
ChildAnswer run_in_child(const std::function<bool(const Send&)>& work, std::size_t most, const ChildLimits& limits,
                         const Progress& progress = no_progress());

// The same within the usual limits, for those who need no reason.
std::optional<std::string> run_in_child(const std::function<bool(const Send&)>& work, std::size_t most);

}  // namespace limber
