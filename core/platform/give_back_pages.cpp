// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/give_back_pages.h"

#include <sys/mman.h>
#include <unistd.h>

namespace limber {

// Ignores an error of the system: the only consequence is that the memory stays in use.
void give_back_pages(void* begin, std::int64_t bytes) {
  static const std::uintptr_t page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const std::uintptr_t from = reinterpret_cast<std::uintptr_t>(begin), first = (from + page - 1) / page * page,
                       end = (from + static_cast<std::uintptr_t>(bytes)) / page * page;
  if (first < end) madvise(reinterpret_cast<void*>(first), end - first, MADV_DONTNEED);
}

}  // namespace limber
