// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the influences of the corners of a brick's voxels near a seam. Voxels around a corner share a vertex only if
// they are connected there through faces that no seam cuts. Each side of the seam has its own vertex. Voxels that touch
// only along an edge, as skin does in the crease beside a seam, have separate vertices too. Therefore each of the eight
// corners of each voxel has its own influences.
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
  // Keeps references to its arguments, which must outlive this object. `tissue` must have seams.
  //   moves_as  for each bone, the first bone with the same motion; that bone gets the weight (BrickMotions)
  SplitCorners(const TissueVoxels& tissue, const SkinWeights& weights, const std::vector<int>& moves_as,
               std::int64_t brick);

  // Returns the influences of a voxel's corner, ascending by bone: the sum of the influences of joined_voxels().
  //   voxel   position in the brick, 0 to 7 on each axis; must be tissue
  //   corner  bits 0, 1, 2 are x, y, z
  std::span<const BoneWeight> at(const glm::ivec3& voxel, int corner);
  // Returns which of the eight voxels around a corner of `voxel` are connected with `voxel` through faces within these
  // eight: one bit for each, starting with the lowest voxel.
  unsigned joined_voxels(const glm::ivec3& voxel, int corner) const;

 private:
  static constexpr int kHalo = TissueVoxels::kBrick + 2;  // edge of a brick with a border one voxel wide
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
