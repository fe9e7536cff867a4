// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/pages.h"

#include <sys/mman.h>
#include <unistd.h>

namespace limber {

namespace {

struct Pages {
  void* begin = nullptr;
  std::uintptr_t bytes = 0;
};

// The whole pages of a range.
Pages pages_of(void* begin, std::int64_t bytes) {
  static const std::uintptr_t page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const std::uintptr_t from = reinterpret_cast<std::uintptr_t>(begin), first = (from + page - 1) / page * page,
                       end = (from + static_cast<std::uintptr_t>(bytes)) / page * page;
  return first < end ? Pages{reinterpret_cast<void*>(first), end - first} : Pages{};
}

}  // namespace

// In both a refusal costs time or memory, nothing else.
void want_large_pages(void* begin, std::int64_t bytes) {
  if (const Pages pages = pages_of(begin, bytes); pages.bytes) madvise(pages.begin, pages.bytes, MADV_HUGEPAGE);
}

void give_back_zeros(void* begin, std::int64_t bytes) {
  const Pages pages = pages_of(begin, bytes);
  if (!pages.bytes) return;
  // Large pages would be filled whole for one voxel.
  madvise(pages.begin, pages.bytes, MADV_NOHUGEPAGE);
  madvise(pages.begin, pages.bytes, MADV_DONTNEED);
}

}  // namespace limber
