// SPDX-License-Identifier: AGPL-3.0-or-later
// The memory pages under large vectors. A posed body's grid is mostly air: sparse_zeros takes memory only where something
// else than zero is written, because the system lends a shared page of zeros to whoever reads the rest. What will be
// filled whole asks for large pages instead: one fault where there were 512.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace limber {

// For a range of fresh memory that will be filled. Only a wish.
void want_large_pages(void* begin, std::int64_t bytes);

// Gives back the whole pages of a range of heap memory whose bytes are all zero; they stay zero.
void give_back_zeros(void* begin, std::int64_t bytes);

constexpr std::int64_t kLargePage = std::int64_t{2} << 20;

//   T  a type whose zero is all bytes zero
template <class T>
std::vector<T> sparse_zeros(std::int64_t count) {
  std::vector<T> zeros;
  zeros.reserve(count);
  // From one large page's end to the next: the same memory serves for all, and is still in the cache.
  const auto first = reinterpret_cast<std::uintptr_t>(zeros.data());
  for (std::int64_t done = 0; done < count;) {
    const auto from = first + static_cast<std::uintptr_t>(done) * sizeof(T), end = (from / kLargePage + 1) * kLargePage;
    const std::int64_t grown = std::min(count, done + std::max<std::int64_t>(1, static_cast<std::int64_t>((end - from) / sizeof(T))));
    const std::int64_t bytes = (grown - done) * std::int64_t{sizeof(T)};
    if (count > kLargePage) want_large_pages(zeros.data() + done, bytes);
    zeros.resize(grown, T(0));
    if (count > kLargePage) give_back_zeros(zeros.data() + done, bytes);
    done = grown;
  }
  return zeros;
}

}  // namespace limber
