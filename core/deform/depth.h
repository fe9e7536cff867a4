// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes how deep a rest point lies below air: the exact Euclidean distance from every tissue voxel's centre to the
// nearest air voxel's centre (everything outside the grid is air), trilinearly interpolated between centres. Depth
// decides folds: if two parts of the body are posed into one voxel, the deeper part keeps the voxel, so the border
// between the two runs where both are equally deep.
//
// There is one pass per axis over columns of tissue bricks. Along x, the nearest air is at the nearer end of a run of
// tissue. Along y and z every voxel searches outwards, several lines at a time, until it is further away than the
// distance found so far [as Saito & Toriwaki 1994]. The search skips bricks whose least value is too large, so that
// deep inside a body it takes one step for eight voxels.
//
// If voxels are cubes, squared depths are whole multiples of a voxel's squared edge length. They are computed and
// stored as these integers, which is exact and takes half the memory of floats.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/volume/tissue_voxels.h"

namespace limber {

class TissueDepth {
 public:
  // Keeps a reference to `tissue`, which must outlive this object.
  //   spacing     size of a voxel, mm
  //   most_steps  for cubic voxels: if a squared depth, in squared voxel edges, exceeds this limit, all depths are
  //               computed as floats instead of integers; at most 65 534
  TissueDepth(const TissueVoxels& tissue, const glm::dvec3& spacing, int most_steps = 65534);

  static constexpr int kBrickVoxels = 512;

  // Returns the depth of a voxel's centre in mm; 0 in air and outside the grid.
  float at_voxel(const glm::ivec3& voxel) const {
    const glm::ivec3 size = tissue_->grid_size();
    const auto inside = [](int v, int end) { return static_cast<unsigned>(v) < static_cast<unsigned>(end); };
    if (!inside(voxel.x, size.x) || !inside(voxel.y, size.y) || !inside(voxel.z, size.z)) return 0;
    const int brick = tissue_->brick_at(voxel);
    return brick < 0 ? 0
                     : at(std::int64_t{brick} * kBrickVoxels + (voxel.x & 7) + 8 * (voxel.y & 7) + 64 * (voxel.z & 7));
  }
  // Returns the depth in mm at a point in voxel coordinates, interpolated trilinearly.
  double operator()(const glm::dvec3& rest) const;

 private:
  // Computes the squared depth of every voxel, in the squared unit of `spacing`.
  template <class Value>
  void measure(ZeroedVector<Value>& squared, const glm::dvec3& spacing) const;

  float at(std::int64_t place) const {
    return std::sqrt(steps_.empty() ? squared_[place] : static_cast<float>(squared_step_ * steps_[place]));
  }

  const TissueVoxels* tissue_;
  // Squared depths, 512 values per tissue brick. Only one of squared_ and steps_ is used.
  ZeroedVector<float> squared_;        // mm2; empty: the depths are in steps_
  ZeroedVector<std::uint16_t> steps_;  // in units of squared_step_; empty: the depths are in squared_
  double squared_step_ = 0;            // value of one unit of steps_, mm2
};

}  // namespace limber
