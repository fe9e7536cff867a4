// SPDX-License-Identifier: AGPL-3.0-or-later
// Work that may crash, done where a crash does no harm: in a forked child that sends bytes back. For libraries that end
// the process on bad input.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace limber {

using Send = std::function<void(const void* bytes, std::size_t size)>;

// What `work` sent, or nothing when it returned false, crashed, sent more than `most` bytes, or took more than 20 s of
// processor time. The child has no standard error of its own, and nothing it changes in memory is seen here.
std::optional<std::string> run_in_child(const std::function<bool(const Send&)>& work, std::size_t most);

}  // namespace limber
