// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/large_blocks.h"

#include <cstdint>
#include <cstdlib>
#include <new>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include "core/platform/memory_pages.h"

// In a build with a sanitizer, operator new is not replaced, so that the sanitizer's own allocator stays in use.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LIMBER_HAS_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define LIMBER_HAS_SANITIZER
#endif
#endif

namespace {
constexpr std::size_t kLarge = std::size_t{8} << 20;
}  // namespace

namespace limber {

void use_large_blocks() {
#if defined(__GLIBC__)
  mallopt(M_MMAP_THRESHOLD, kLarge);
  mallopt(M_TRIM_THRESHOLD, 4 * kLarge);
#endif
}

void return_free_memory() {
#if defined(__GLIBC__)
  malloc_trim(0);
#endif
}

}  // namespace limber

#if defined(__GLIBC__) && !defined(LIMBER_HAS_SANITIZER)
namespace {
constexpr std::size_t kLargePage = std::size_t{2} << 20;

void* large_block(std::size_t size) {
  void* block = nullptr;
  if (posix_memalign(&block, kLargePage, size) != 0) return nullptr;
  limber::want_large_pages(block, static_cast<std::int64_t>(size));
  return block;
}
}  // namespace

void* operator new(std::size_t size) {
  for (;;) {
    if (void* block = size >= kLarge ? large_block(size) : std::malloc(size > 0 ? size : 1)) return block;
    const std::new_handler handler = std::get_new_handler();
    if (!handler) throw std::bad_alloc();
    handler();
  }
}

void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }
#endif
