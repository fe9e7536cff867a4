// SPDX-License-Identifier: AGPL-3.0-or-later
// What the corners of a brick's voxels follow where a seam is near. The voxels around a corner that do not hang
// together there, through faces that are not cut, share no vertex: each side has its own, and so have voxels that touch
// along an edge only, as skin does in the crease beside a seam. So every voxel is asked for its own eight corners.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/deform/skinning.h"
#include "core/skin/skin_weights.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

class SplitCorners {
 public:
  // References are kept; `tissue` has seams.
  //   moves_as  per bone: the one it is counted as
  SplitCorners(const TissueVoxels& tissue, const SkinWeights& weights, const std::vector<int>& moves_as,
               std::int64_t brick);

  // The influences of a voxel's corner in rising bone order, summed over the voxels that hang together with it there.
  //   voxel   of the brick, 0 .. 7 on each axis; it must be tissue
  //   corner  bit 0 is x, bit 1 y, bit 2 z
  std::span<const BoneWeight> at(const glm::ivec3& voxel, int corner);
  // A bit for each of the eight voxels around the corner, the lowest first, that hangs together with the voxel there.
  unsigned joined_voxels(const glm::ivec3& voxel, int corner) const;

 private:
  static constexpr int kHalo = TissueVoxels::kBrick + 2;  // a brick and one voxel around it
  static int place(const glm::ivec3& v) { return v.x + 1 + kHalo * (v.y + 1 + kHalo * (v.z + 1)); }
  void add(const Influence& influence);

  const Seams& seams_;
  const std::vector<int>& moves_as_;
  glm::ivec3 corner_;  // the brick's lowest voxel
  std::array<Influence, kHalo * kHalo * kHalo> influence_;
  std::array<bool, kHalo * kHalo * kHalo> is_tissue_{};
  std::array<BoneWeight, 32> sum_;
  int bones_ = 0;
};

}  // namespace limber
