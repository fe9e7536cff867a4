// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/memory_pages.h"

#include <cstdlib>
#include <cstring>

#include <sys/mman.h>
#include <unistd.h>

namespace limber {

namespace {

struct Pages {
  void* begin = nullptr;
  std::uintptr_t bytes = 0;
};

// Returns the memory pages that lie completely inside a range of addresses.
Pages pages_of(void* begin, std::int64_t bytes) {
  static const std::uintptr_t page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const std::uintptr_t from = reinterpret_cast<std::uintptr_t>(begin), first = (from + page - 1) / page * page,
                       end = (from + static_cast<std::uintptr_t>(bytes)) / page * page;
  return first < end ? Pages{reinterpret_cast<void*>(first), end - first} : Pages{};
}

}  // namespace

// Ignores an error of the system, because it only costs speed.
void want_large_pages(void* begin, std::int64_t bytes) {
  if (const Pages pages = pages_of(begin, bytes); pages.bytes) madvise(pages.begin, pages.bytes, MADV_HUGEPAGE);
}

namespace {
// Size in bytes (1 GB) from which a block is mapped without reserving physical memory for all of it.
constexpr std::size_t kUnreserved = std::size_t{1} << 30;

void* map_unreserved(std::size_t bytes) {
  void* begin = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  return begin == MAP_FAILED ? nullptr : begin;
}
}  // namespace

void* new_zeros(std::size_t bytes) {
  return bytes < kUnreserved ? std::calloc(bytes > 0 ? bytes : 1, 1) : map_unreserved(bytes);
}

void delete_zeros(void* begin, std::size_t bytes) {
  if (bytes < kUnreserved) std::free(begin);
  else munmap(begin, bytes);
}

bool can_map(std::size_t bytes) {
  void* room = map_unreserved(bytes);
  if (room) munmap(room, bytes);
  return room != nullptr;
}

bool is_all_zero(const void* begin, std::size_t bytes) {
  const auto* byte = static_cast<const unsigned char*>(begin);
  return bytes == 0 || (*byte == 0 && std::memcmp(byte, byte + 1, bytes - 1) == 0);
}

}  // namespace limber
