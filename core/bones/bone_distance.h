// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the signed distance to the surface of one bone near a joint. It uses a lattice of cubes, so that distances
// are equally exact in every direction also where slices are thick: there the bone's membership is interpolated between
// slices first, and the surface is where the membership is one half. Points are in mm along the axes of the volume's
// grid, from the centre of voxel 0.
#pragma once

#include <optional>
#include <vector>

#include "core/volume/distance_transform.h"

namespace limber {

class BoneDistance {
 public:
  struct Sample {
    double mm;         // signed distance to the surface, negative inside the bone
    glm::dvec3 slope;  // gradient of the signed distance
  };
  struct SurfacePoint {
    glm::dvec3 place;
    double mm;
  };

  // Builds a lattice over the voxel centres of `box`, with the smallest spacing as its edge. Voxels outside the box are
  // ignored: a bone that goes on beyond the box has no surface there.
  //   voxels  all voxels of the bone
  BoneDistance(const glm::dvec3& spacing, const std::vector<glm::ivec3>& voxels, const VoxelBox& box);

  double edge_mm() const { return edge_; }
  // Returns the distance at a point, linear between lattice points; none outside the lattice.
  std::optional<Sample> at(const glm::dvec3& point) const;
  // Returns the distance at a point like at(), but none also where all lattice points around it are `limit` mm or more
  // from the bone. This fast test rejects most points of a long list.
  std::optional<Sample> below(const glm::dvec3& point, double limit) const;
  // Returns how far a point lies outside the lattice, mm: the largest distance along one axis, 0 inside.
  double outside(const glm::dvec3& point) const;
  // Returns the lattice points next to the surface, on both sides, x fastest.
  std::vector<SurfacePoint> surface() const;

 private:
  bool holds(const glm::dvec3& place) const;

  glm::dvec3 lowest_;
  double edge_;
  VoxelBox lattice_;
  // The signed distance at each lattice point, and the smallest of the eight distances at the corners of the lattice
  // cell that begins at the point.
  std::vector<float> mm_, least_;
};

}  // namespace limber
