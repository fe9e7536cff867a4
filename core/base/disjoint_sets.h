// SPDX-License-Identifier: AGPL-3.0-or-later
// Sets of the numbers 0 to n - 1 that are united step by step [Tarjan, Efficiency of a good but not linear set union
// algorithm, J. ACM 1975].
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace limber {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  // Returns the least number of the set that contains `i`.
  std::int32_t least(std::int32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::int32_t a, std::int32_t b) {
    a = least(a), b = least(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::int32_t> parent_;
};

}  // namespace limber
