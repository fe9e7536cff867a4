// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes exact Euclidean distances in a box of voxels: for every voxel, the distance from its centre to the centre of
// the nearest seed voxel. There is one pass per axis. Along a line of voxels the result is the lower envelope of one
// parabola per voxel [Felzenszwalb & Huttenlocher 2012], so the time is linear in the number of voxels. Where all seeds
// are near, each voxel instead tries every position of its line that can be nearer. This works on several lines at a
// time and takes less time than the envelope.
//
// Squared distances are stored as floats between the passes. They are exact for distances up to 4096 mm when the
// spacing is isotropic and a whole number of mm, else accurate to 1e-6 of the value.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/volume/label_volume.h"

namespace limber {

// A part of a grid: voxels lowest .. lowest + size - 1, stored x fastest.
struct VoxelBox {
  glm::ivec3 lowest{0}, size{0};

  std::int64_t voxel_count() const { return std::int64_t{size.x} * size.y * size.z; }
  std::int64_t index(const glm::ivec3& voxel) const {
    const glm::ivec3 v = voxel - lowest;
    return v.x + std::int64_t{size.x} * (v.y + std::int64_t{size.y} * v.z);
  }
  bool contains(const glm::ivec3& voxel) const {
    const glm::ivec3 v = voxel - lowest;
    return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < size.x && v.y < size.y && v.z < size.z;
  }
};

// Returns the smallest box that holds all tissue, extended by `margin` voxels on each side as far as the grid reaches.
// The box has size 0 when all voxels are air.
VoxelBox tissue_box(const LabelVolume& volume, int margin = 0);

// Returns the squared distance, mm2, of every voxel of the box to the nearest seed; infinity when there is no seed.
//   seed     one byte per voxel of the box, not 0 where the voxel is a seed
//   spacing  mm, positive
std::vector<float> squared_distance(const VoxelBox& box, const std::vector<std::uint8_t>& seed,
                                    const glm::dvec3& spacing, Progress& progress = no_progress());

// Returns the signed distance of every voxel of the box in mm, between voxel centres. A voxel outside the body has the
// distance to the nearest voxel of the body. A voxel of the body has minus the distance to the nearest voxel outside
// the body. Voxels beyond the box are unknown, so a body that touches the box's faces has no border there.
std::vector<float> signed_distance(const VoxelBox& box, const std::vector<std::uint8_t>& body,
                                   const glm::dvec3& spacing, Progress& progress = no_progress());

}  // namespace limber
