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

//   T  a type whose zero is all bytes zero
template <class T>
std::vector<T> sparse_zeros(std::int64_t count) {
  constexpr std::int64_t kStep = (std::int64_t{8} << 20) / sizeof(T);  // never more than this is there at once
  std::vector<T> zeros;
  zeros.reserve(count);
  while (std::ssize(zeros) < count) {
    const std::int64_t before = std::ssize(zeros), grown = std::min(count, before + kStep);
    if (count > kStep) want_large_pages(zeros.data() + before, (grown - before) * std::int64_t{sizeof(T)});
    zeros.resize(grown, T(0));
    if (count > kStep) give_back_zeros(zeros.data() + before, (grown - before) * std::int64_t{sizeof(T)});
  }
  return zeros;
}

}  // namespace limber
