// SPDX-License-Identifier: AGPL-3.0-or-later
// A set of tissue voxels with one bit per voxel, stored in the bricks of a TissueVoxels list (8^3 voxels each). It is
// extended to connected voxels by operations on 64 voxels at a time.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/volume/tissue_voxels.h"

namespace limber {

class TissueSet {
 public:
  // Creates an empty set that keeps a reference to `tissue`.
  explicit TissueSet(const TissueVoxels& tissue) : tissue_(tissue), bricks_(tissue.bricks().size(), Brick{}) {}

  // Adds a voxel, which must be tissue.
  void add(const glm::ivec3& voxel) { slice(voxel) |= bit(voxel); }
  bool contains(const glm::ivec3& voxel) const { return slice(voxel) & bit(voxel); }

  // Adds all voxels of `within` that can be reached from voxels of this set, from voxel to voxel of `within` through
  // their faces. Paths may cross seams.
  //   within  a set over the same TissueVoxels list
  void spread(const TissueSet& within);

 private:
  using Brick = std::array<std::uint64_t, 8>;  // one word per z slice; bit x + 8 y is voxel (x, y)

  static std::uint64_t bit(const glm::ivec3& v) { return std::uint64_t{1} << ((v.x & 7) + 8 * (v.y & 7)); }
  std::uint64_t& slice(const glm::ivec3& v) { return bricks_[tissue_.brick_at(v)][v.z & 7]; }
  std::uint64_t slice(const glm::ivec3& v) const { return bricks_[tissue_.brick_at(v)][v.z & 7]; }

  const TissueVoxels& tissue_;
  std::vector<Brick> bricks_;
};

}  // namespace limber
