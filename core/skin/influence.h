// SPDX-License-Identifier: AGPL-3.0-or-later
// The influence of bones on a tissue voxel: up to four bones with their weights, whole numbers in 1/65535 that sum to
// exactly 65535.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace limber {

constexpr int kFullWeight = 65535;

struct Influence {
  std::array<std::uint16_t, 4> bone{};    // bone indices in descending order of weight; 0 where the weight is 0
  std::array<std::uint16_t, 4> weight{};  // in 1/65535; the sum is exactly kFullWeight

  bool operator==(const Influence&) const = default;
  double of(int b) const {
    for (int i = 0; i < 4; ++i)
      if (bone[i] == b && weight[i]) return weight[i] / double(kFullWeight);
    return 0;
  }
};

Influence rigid_influence(int bone);

// Returns the influence with the four largest of `weights`, scaled and rounded so that their sum is exactly
// kFullWeight. Any number of weights with any sum may be given. No weight may be negative. Throws std::logic_error if
// the sum is zero.
Influence quantize(const std::vector<std::pair<int, double>>& weights);

}  // namespace limber
