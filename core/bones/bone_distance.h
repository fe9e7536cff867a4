// SPDX-License-Identifier: AGPL-3.0-or-later
// The signed distance to the surface of one bone near a joint, on a lattice of cubes, so that distances mean the same
// in every direction also where slices are thick: there the bone's membership is interpolated between slices first,
// and the surface runs where it is one half. Points are in mm along the axes of the volume's grid, from the centre of
// voxel 0.
#pragma once

#include <optional>
#include <vector>

#include "core/volume/distance_transform.h"

namespace limber {

class BoneDistance {
 public:
  struct Sample {
    double mm;         // to the surface, negative inside the bone
    glm::dvec3 slope;  // its gradient
  };
  struct SurfacePoint {
    glm::dvec3 place;
    double mm;
  };

  // The lattice covers the voxel centres of `box`, its edge is the smallest spacing. Bone outside the box is not
  // seen: a bone that goes on beyond it has no surface there.
  //   voxels  of the bone; those outside the box are ignored
  BoneDistance(const glm::dvec3& spacing, const std::vector<glm::ivec3>& voxels, const VoxelBox& box);

  double edge_mm() const { return edge_; }
  // Linear between lattice points; none outside of the lattice.
  std::optional<Sample> at(const glm::dvec3& point) const;
  // The same, and none where all lattice points around are `limit` mm or further from the bone: of many points that are
  // looked at only some can lie in it.
  std::optional<Sample> below(const glm::dvec3& point, double limit) const;
  // How far a point lies outside of the lattice along the axis where it is most, mm; 0 in it.
  double outside(const glm::dvec3& point) const;
  // The lattice points next to the surface, on both sides, x fastest.
  std::vector<SurfacePoint> surface() const;

 private:
  bool holds(const glm::dvec3& place) const;

  glm::dvec3 lowest_;
  double edge_;
  VoxelBox lattice_;
  std::vector<float> mm_, least_;  // at each lattice point, and of the eight from it on
};

}  // namespace limber
