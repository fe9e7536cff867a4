// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs work that may crash in a forked child process, so that a crash does not harm this process. The child sends its
// result back as bytes. This is meant for libraries that end the process on bad input.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>

namespace limber {

using Send = std::function<void(const void* bytes, std::size_t size)>;

struct ChildLimits {
  double processor_seconds = 20;  // limit of the child's processor time, rounded up to whole seconds
  // Limit of elapsed (wall-clock) time, which also counts sleep.
  double seconds = std::numeric_limits<double>::infinity();
  std::size_t memory_bytes = 0;  // limit of the child's memory beyond what this process has mapped; 0: no limit
};

struct ChildAnswer {
  std::optional<std::string> sent;  // the bytes that the child sent; none when it failed
  std::string failure;     // why the work failed, for example "the process took too long"; empty when it did not fail
  bool cancelled = false;  // true: the work was ended because the user had cancelled it
};

// Returns true when the user has cancelled the work. It is called about every 20 ms.
using AskCancelled = std::function<bool()>;

// Runs `work` in a child process and returns the bytes that the child sent. Returns no bytes but the reason when `work`
// returned false, threw, crashed, ended the process, sent more than `most` bytes or exceeded a limit. The child writes
// its standard output and error to /dev/null, its changes to memory are not seen here, and it is killed when the thread
// that waits for it ends, or when `cancelled` returns true.
ChildAnswer run_in_child(const std::function<bool(const Send&)>& work, std::size_t most, const ChildLimits& limits,
                         const AskCancelled& cancelled = {});

// Runs `work` in a child process within the default limits, for callers that do not need the reason of a failure.
// Returns the sent bytes, or nothing after a failure.
std::optional<std::string> run_in_child(const std::function<bool(const Send&)>& work, std::size_t most);

}  // namespace limber
