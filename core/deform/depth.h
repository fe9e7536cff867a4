// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes how deep a rest point lies below air: the exact Euclidean distance from every tissue voxel's centre to the
// nearest air voxel's centre (everything outside the grid is air), interpolated between centres, so that it is
// continuous. Depth resolves folds: if two parts of the body are posed into one voxel, the deeper one stays, and the
// border between them runs where both are equally deep.
//
// There is one pass per axis over columns of tissue bricks. Along x, the nearest air is at the nearer end of a run of
// tissue. Along y and z every voxel searches outwards, eight lines at a time, until it is further away than the
// distance found so far [as Saito & Toriwaki 1994]: the number of steps grows with the depth, and each step takes a few
// machine instructions for all eight.
#pragma once

#include <vector>

#include "core/volume/tissue_voxels.h"

namespace limber {

class TissueDepth {
 public:
  // Keeps a reference to `tissue`, which must outlive this object.
  //   spacing  size of a voxel, mm
  TissueDepth(const TissueVoxels& tissue, const glm::dvec3& spacing);

  // Returns the depth of a voxel's centre in mm; 0 in air and outside the grid.
  float at_voxel(const glm::ivec3& voxel) const {
    const glm::ivec3 size = tissue_->grid_size();
    const auto inside = [](int v, int end) { return static_cast<unsigned>(v) < static_cast<unsigned>(end); };
    if (!inside(voxel.x, size.x) || !inside(voxel.y, size.y) || !inside(voxel.z, size.z)) return 0;
    const int brick = tissue_->brick_at(voxel);
    return brick < 0
               ? 0
               : depth_[std::int64_t{brick} * kBrickVoxels + (voxel.x & 7) + 8 * (voxel.y & 7) + 64 * (voxel.z & 7)];
  }
  // Returns the depth in mm at a point in voxel coordinates, interpolated trilinearly.
  double operator()(const glm::dvec3& rest) const;

 private:
  static constexpr int kBrickVoxels = 512;
  // Calls body(bricks) for each run of adjacent tissue bricks along the axis. Either end of a run borders on air.
  template <class Body>
  void for_each_column(int axis, const Body& body);
  void pass_along_x(double spacing);
  void pass_across(int axis, double spacing);

  const TissueVoxels* tissue_;
  std::vector<float> depth_;  // 512 depths per tissue brick, mm; squared until the constructor ends
};

}  // namespace limber
