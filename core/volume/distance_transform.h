// SPDX-License-Identifier: AGPL-3.0-or-later
// Exact Euclidean distance in a box of voxels: for every voxel, how far its centre lies from the centre of the nearest
// seed voxel. One pass per axis; along a line the result is the lower envelope of one parabola per voxel
// [Felzenszwalb & Huttenlocher 2012], so the cost is linear in voxels. Where all seeds lie near, each voxel tries every
// place of its line that can be nearer, several lines at a time, which costs less than the envelope.
//
// Squared distances are kept as floats between the passes: exact for whole-number isotropic spacings up to 4096 voxels,
// else right to 1e-6 of the value.
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

// The smallest box around all tissue, grown by `margin` voxels but kept inside the grid. Size 0 when all is air.
VoxelBox tissue_box(const LabelVolume& volume, int margin = 0);

// Squared distance, mm2, of every voxel of the box to the nearest seed; infinity when there is none.
//   seed     #box bytes, not 0 where a voxel is a seed
//   spacing  mm, positive
std::vector<float> squared_distance(const VoxelBox& box, const std::vector<std::uint8_t>& seed,
                                    const glm::dvec3& spacing, Progress& progress = no_progress());

// Distance in mm to the border of a body, measured between voxel centres: positive outside (to the nearest voxel of
// the body), negative inside (to the nearest voxel that is not of the body). Around the box nothing is known, so a
// body that touches the box's faces is not closed there.
std::vector<float> signed_distance(const VoxelBox& box, const std::vector<std::uint8_t>& body,
                                   const glm::dvec3& spacing, Progress& progress = no_progress());

}  // namespace limber
