// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the signed distance to the surface of one bone near a joint. The distances are stored on a lattice of cubes,
// so that they are equally accurate in every direction even if slices are thick. In that case the share of bone is
// first interpolated between slices, and the surface is where the share is one half. Points are in mm along the axes of
// the volume's grid, relative to the centre of voxel 0.
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

  // Builds a lattice over the voxel centres of `box`. The lattice spacing is the smallest voxel spacing. Voxels outside
  // the box are ignored: a bone that continues beyond the box has no surface there.
  //   voxels  all voxels of the bone
  BoneDistance(const glm::dvec3& spacing, const std::vector<glm::ivec3>& voxels, const VoxelBox& box);

  double edge_mm() const { return edge_; }
  // Returns the distance at a point, interpolated linearly between lattice points. Returns none outside the lattice.
  std::optional<Sample> at(const glm::dvec3& point) const;
  // Returns the distance at a point like at(), but also returns none if all lattice points around the point are `limit`
  // mm or more from the bone. This fast test rejects most points of a long list.
  std::optional<Sample> below(const glm::dvec3& point, double limit) const;
  // Returns how far a point lies outside the lattice, mm: the largest of the distances along the axes. 0: inside.
  double outside(const glm::dvec3& point) const;
  // Returns the lattice points next to the surface, on both of its sides, in the lattice's order (x fastest).
  std::vector<SurfacePoint> surface() const;

 private:
  // A place is a point in lattice units, (0, 0, 0) at the lattice's first point.
  bool holds(const glm::dvec3& place) const;
  Sample sample(const glm::dvec3& place) const;  // requires a place inside the lattice

  glm::dvec3 lowest_;
  double edge_;
  VoxelBox lattice_;
  // mm_: signed distance at each lattice point. least_: smallest of the eight distances at the corners of the lattice
  // cell that begins at the point.
  std::vector<float> mm_, least_;
};

}  // namespace limber
