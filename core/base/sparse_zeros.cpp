// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/sparse_zeros.h"

#include <sys/mman.h>
#include <unistd.h>

namespace limber {

// A refusal costs memory, nothing else.
void give_back_zeros(void* begin, std::int64_t bytes) {
  static const std::uintptr_t page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const std::uintptr_t from = reinterpret_cast<std::uintptr_t>(begin), first = (from + page - 1) / page * page,
                       end = (from + static_cast<std::uintptr_t>(bytes)) / page * page;
  if (first >= end) return;
  void* pages = reinterpret_cast<void*>(first);
  // Huge pages would be filled whole for one voxel.
  madvise(pages, end - first, MADV_NOHUGEPAGE);
  madvise(pages, end - first, MADV_DONTNEED);
}

}  // namespace limber
