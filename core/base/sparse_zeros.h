// SPDX-License-Identifier: AGPL-3.0-or-later
// Large vectors of zeros that take memory only where something else is written into them: a posed body's grid is mostly
// air. The pages are given back to the system, which lends a shared page of zeros to whoever reads them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace limber {

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
    zeros.resize(grown, T(0));
    if (count > kStep) give_back_zeros(zeros.data() + before, (grown - before) * std::int64_t{sizeof(T)});
  }
  return zeros;
}

}  // namespace limber
