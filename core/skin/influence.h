// SPDX-License-Identifier: AGPL-3.0-or-later
// Which bones a tissue voxel follows, and by how much: up to four, in whole numbers of 1/65535 that sum to exactly
// 65535.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace limber {

constexpr int kFullWeight = 65535;

struct Influence {
  std::array<std::uint16_t, 4> bone{};    // by falling weight; 0 where the weight is 0
  std::array<std::uint16_t, 4> weight{};  // in 1/65535, sum exactly kFullWeight

  bool operator==(const Influence&) const = default;
  double of(int b) const {
    for (int i = 0; i < 4; ++i)
      if (bone[i] == b && weight[i]) return weight[i] / double(kFullWeight);
    return 0;
  }
};

Influence rigid_influence(int bone);

// The four largest of `weights` (any length, not negative, need not sum to one), rounded so that the sum is exact.
// A sum of zero is a mistake of the caller.
Influence quantize(const std::vector<std::pair<int, double>>& weights);

}  // namespace limber
