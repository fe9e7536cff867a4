// SPDX-License-Identifier: AGPL-3.0-or-later
// How deep a rest point lies below air: exact Euclidean distance from every tissue voxel's centre to the nearest air
// voxel's (everything outside the grid is air), interpolated between centres, so that it is continuous. It decides
// folds: of two places of the body that come to lie in one voxel the deeper stays, and the cut runs where both are
// equally deep.
//
// One pass per axis over columns of tissue bricks. Along x, between two voxels of air, the nearer end is nearest. Along
// y and z every voxel looks outward, eight lines at a time, until it is further away than what it has found [as Saito &
// Toriwaki 1994]: steps go with the depth, and each is a few machine instructions for all eight.
#pragma once

#include <vector>

#include "core/volume/tissue_voxels.h"

namespace limber {

class TissueDepth {
 public:
  // Keeps a reference to `tissue`.    spacing  mm
  TissueDepth(const TissueVoxels& tissue, const glm::dvec3& spacing);

  // mm, 0 in air and outside
  float at_voxel(const glm::ivec3& voxel) const {
    const glm::ivec3 size = tissue_->grid_size();
    const auto inside = [](int v, int end) { return static_cast<unsigned>(v) < static_cast<unsigned>(end); };
    if (!inside(voxel.x, size.x) || !inside(voxel.y, size.y) || !inside(voxel.z, size.z)) return 0;
    const int brick = tissue_->brick_at(voxel);
    return brick < 0
               ? 0
               : depth_[std::int64_t{brick} * kBrickVoxels + (voxel.x & 7) + 8 * (voxel.y & 7) + 64 * (voxel.z & 7)];
  }
  double operator()(const glm::dvec3& rest) const;  // mm, trilinear; voxel coordinates

 private:
  static constexpr int kBrickVoxels = 512;
  // body(bricks of one column, air before the first and after the last)
  template <class Body>
  void for_each_column(int axis, const Body& body);
  void pass_along_x(double spacing);
  void pass_across(int axis, double spacing);

  const TissueVoxels* tissue_;
  std::vector<float> depth_;  // 512 per tissue brick; squared while the passes run
};

}  // namespace limber
