// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds where stretches of air and of tissue end along a row of labels, several voxels at a time.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "core/volume/label_volume.h"

namespace limber {

// Returns the first position in the row, from `x` on, that is not air; `size` when there is none.
inline int end_of_air(const Label* row, int x, int size) {
  for (std::uint64_t words[4]; x + 16 <= size; x += 16) {
    std::memcpy(words, row + x, sizeof words);
    if (words[0] | words[1] | words[2] | words[3]) break;
  }
  for (std::uint64_t word; x + 4 <= size; x += 4) {
    std::memcpy(&word, row + x, sizeof word);
    if (word) return x + std::countr_zero(word) / 16;
  }
  while (x < size && row[x] == 0) ++x;
  return x;
}

// Returns the first position in the row, from `x` on, that is air; `size` when there is none.
inline int end_of_tissue(const Label* row, int x, int size) {
  constexpr std::uint64_t kOnes = 0x0001000100010001, kHighest = kOnes << 15;
  for (std::uint64_t word; x + 4 <= size; x += 4) {
    std::memcpy(&word, row + x, sizeof word);
    // The lowest set bit of `air` is in the 16 bits of the first label that is 0.
    if (const std::uint64_t air = (word - kOnes) & ~word & kHighest) return x + std::countr_zero(air) / 16;
  }
  while (x < size && row[x] != 0) ++x;
  return x;
}

}  // namespace limber
