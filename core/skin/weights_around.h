// SPDX-License-Identifier: AGPL-3.0-or-later
// The weights of voxels beside each other: a brick and the six around it, looked at without searching for each voxel.
#pragma once

#include <array>
#include <bit>

#include "core/skin/skin_weights.h"

namespace limber {

class WeightsAround {
 public:
  // chunk(brick) is an InfluenceView of what lives as long as this.
  template <class ChunkOf>
  WeightsAround(const TissueVoxels& tissue, int brick, const ChunkOf& chunk) {
    const glm::ivec3 corner = tissue.bricks()[brick].corner;
    view_[6] = view(tissue, brick, chunk);
    for (int d = 0; d < 6; ++d) {
      glm::ivec3 beside = corner;
      beside[d >> 1] += d & 1 ? TissueVoxels::kBrick : -TissueVoxels::kBrick;
      const bool inside = beside[d >> 1] >= 0 && beside[d >> 1] < tissue.grid_size()[d >> 1];
      view_[d] = view(tissue, inside ? tissue.brick_at(beside) : -1, chunk);
    }
  }

  // Those of the up to six neighbours through faces that are tissue.    cell  in the brick, [0, 7]
  int beside(const glm::ivec3& cell, std::array<Influence, 6>& found) const {
    int count = 0;
    for (int d = 0; d < 6; ++d) {
      glm::ivec3 v = cell;
      const int axis = d >> 1;
      v[axis] += d & 1 ? 1 : -1;
      const bool inside = v[axis] >= 0 && v[axis] < TissueVoxels::kBrick;
      v[axis] &= TissueVoxels::kBrick - 1;
      const View& view = view_[inside ? 6 : d];
      if (const int at = view.place(v); at >= 0) found[count++] = view.influences[static_cast<std::size_t>(at)];
    }
    return count;
  }

 private:
  struct View {
    const TissueVoxels::Brick* brick = nullptr;
    InfluenceView influences;
    std::array<std::uint16_t, TissueVoxels::kBrick> before{};  // tissue voxels below each slice

    int place(const glm::ivec3& cell) const {  // in the brick, -1: no tissue
      const int bit = cell.x + TissueVoxels::kBrick * cell.y;
      if (!brick || !(brick->mask[cell.z] >> bit & 1)) return -1;
      return before[cell.z] + std::popcount(brick->mask[cell.z] & ((std::uint64_t{1} << bit) - 1));
    }
  };

  template <class ChunkOf>
  static View view(const TissueVoxels& tissue, int brick, const ChunkOf& chunk) {
    View made;
    if (brick < 0) return made;
    made.brick = &tissue.bricks()[brick];
    made.influences = chunk(brick);
    int before = 0;
    for (int z = 0; z < TissueVoxels::kBrick; ++z) {
      made.before[z] = static_cast<std::uint16_t>(before);
      before += std::popcount(made.brick->mask[z]);
    }
    return made;
  }

  std::array<View, 7> view_;
};

// Weights of several voxels added up, each times a factor.
using WeightSum = std::vector<std::pair<int, double>>;

inline void add_to(WeightSum& sum, const Influence& influence, double factor) {
  for (int i = 0; i < 4; ++i) {
    if (influence.weight[i] == 0) continue;
    const int bone = influence.bone[i];
    std::size_t k = 0;
    while (k < sum.size() && sum[k].first != bone) ++k;
    if (k < sum.size())
      sum[k].second += factor * influence.weight[i];
    else
      sum.emplace_back(bone, factor * influence.weight[i]);
  }
}

}  // namespace limber
