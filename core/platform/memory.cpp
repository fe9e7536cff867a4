// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/memory.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>

namespace limber {

namespace {
// Returns the number that follows `key` at the start of a line of a file. Returns -1 when there is no number; without a
// limit, the memory file of a control group holds the word "max" instead.
std::int64_t number_in_file(const char* path, std::string_view key) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t first = line.find_first_not_of(" \t", key.size());
    if (first == std::string::npos || line[first] < '0' || line[first] > '9') return -1;
    return std::stoll(line.substr(first));
  }
  return -1;
}
}  // namespace

std::int64_t available_memory() {
  std::int64_t available = std::numeric_limits<std::int64_t>::max();
  if (const std::int64_t kib = number_in_file("/proc/meminfo", "MemAvailable:"); kib >= 0) available = kib * 1024;
  const std::int64_t most = number_in_file("/sys/fs/cgroup/memory.max", ""),
                     used = number_in_file("/sys/fs/cgroup/memory.current", "");
  if (most > 0 && used >= 0) available = std::min(available, std::max<std::int64_t>(0, most - used));
  return available;
}

}  // namespace limber
