// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs work that may crash in a forked child process, which sends its result back as bytes; a crash there does not harm
// this process. It is meant for libraries that end the process on bad input.
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
  double processor_seconds = 20;  // limit of the child's processor time, rounded up to whole seconds
  double seconds = std::numeric_limits<double>::infinity();  // limit of elapsed time, which also counts sleep
  std::size_t memory_bytes = 0;  // limit beyond what this process has already mapped; 0: none
};

struct ChildAnswer {
  std::optional<std::string> sent;  // the bytes that the child sent; none when it failed
  std::string failure;              // the reason, as in "it crashed (signal 11)"; empty when it did not fail
};

// Runs `work` in a child process and returns what it sent. Returns nothing and the reason when `work` returned false,
// threw, crashed, ended the process, sent more than `most` bytes or exceeded a limit. The child writes its standard
// output and error to /dev/null, its changes to memory are not seen here, and it is killed when the thread that waits
// for it ends.
//   throws Cancelled within about 20 ms of progress.cancel(); the child is killed first
ChildAnswer run_in_child(const std::function<bool(const Send&)>& work, std::size_t most, const ChildLimits& limits,
                         const Progress& progress = no_progress());

// Runs `work` in a child process within the default limits, for callers that do not need the reason of a failure.
std::optional<std::string> run_in_child(const std::function<bool(const Send&)>& work, std::size_t most);

}  // namespace limber
