// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/split_corners.h"

#include <algorithm>
#include <bit>

namespace limber {

SplitCorners::SplitCorners(const TissueVoxels& tissue, const SkinWeights& weights, const std::vector<int>& moves_as,
                           std::int64_t brick)
    : seams_(*tissue.seams()),
      moves_as_(moves_as),
      corner_(tissue.bricks()[brick].corner) {
  for (int z = -1; z <= TissueVoxels::kBrick; ++z)
    for (int y = -1; y <= TissueVoxels::kBrick; ++y)
      for (int x = -1; x <= TissueVoxels::kBrick; ++x) {
        const glm::ivec3 v(x, y, z), at = corner_ + v;
        if (glm::any(glm::lessThan(at, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(at, tissue.grid_size())))
          continue;
        const std::int64_t there = tissue.index_of(at);
        if (there < 0) continue;
        const int holder = tissue.brick_at(at);
        is_tissue_[place(v)] = true;
        influence_[place(v)] = weights.chunk(holder)[there - tissue.bricks()[holder].first];
      }
}

unsigned SplitCorners::joined_voxels(const glm::ivec3& voxel, int corner) const {
  const glm::ivec3 lowest = voxel - 1 + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
  // `joined` and `open` have one bit for each of the eight voxels around the corner: those found so far to be connected
  // with the voxel, and those whose neighbours have not been searched yet. At first both contain only the voxel.
  unsigned joined = 1u << (~corner & 7), open = joined;
  while (open) {
    const int from = std::countr_zero(open);
    open &= open - 1;
    const glm::ivec3 here = lowest + glm::ivec3(from & 1, from >> 1 & 1, from >> 2);
    for (int axis = 0; axis < 3; ++axis) {
      const int to = from ^ 1 << axis;
      if (joined >> to & 1) continue;
      glm::ivec3 there = here;
      const bool up = to > from;
      there[axis] += up ? 1 : -1;
      if (!is_tissue_[place(there)] || seams_.is_cut(corner_ + (up ? here : there), axis)) continue;
      joined |= 1u << to;
      open |= 1u << to;
    }
  }
  return joined;
}

void SplitCorners::add(const Influence& influence) {
  for (int i = 0; i < 4 && influence.weight[i]; ++i) {
    const int bone = moves_as_[influence.bone[i]];
    int at = 0;
    while (at < bones_ && sum_[at].bone < bone) ++at;
    if (at == bones_ || sum_[at].bone != bone) {
      std::copy_backward(sum_.begin() + at, sum_.begin() + bones_, sum_.begin() + bones_ + 1);
      sum_[at] = {bone, 0};
      ++bones_;
    }
    sum_[at].weight += influence.weight[i];
  }
}

std::span<const BoneWeight> SplitCorners::at(const glm::ivec3& voxel, int corner) {
  const glm::ivec3 lowest = voxel - 1 + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
  bones_ = 0;
  unsigned voxels = joined_voxels(voxel, corner);
  for (; voxels; voxels &= voxels - 1) {
    const int v = std::countr_zero(voxels);
    add(influence_[place(lowest + glm::ivec3(v & 1, v >> 1 & 1, v >> 2))]);
  }
  return {sum_.data(), static_cast<size_t>(bones_)};
}

}  // namespace limber
