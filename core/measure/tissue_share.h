// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures smoothly how far a point is inside tissue, for borders finer than voxels.
#pragma once

#include <glm/glm.hpp>

#include "core/volume/label_volume.h"

namespace limber {

// Returns the share [0, 1] of tissue at a point, interpolated between the eight nearest voxel centres. It is 0.5 on the
// border of a flat layer.
//   voxel    the point, in voxel coordinates
//   belongs  a function that returns whether a label counts as tissue; voxels outside the grid are air, label 0
template <class Belongs>
double tissue_share(const LabelVolume& volume, const glm::dvec3& voxel, const Belongs& belongs) {
  const glm::ivec3 low(glm::floor(voxel));
  const glm::dvec3 t = voxel - glm::dvec3(low);
  double share = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 high(corner & 1, corner >> 1 & 1, corner >> 2);
    if (!belongs(volume.at_or_air(low + high))) continue;
    share += (high.x ? t.x : 1 - t.x) * (high.y ? t.y : 1 - t.y) * (high.z ? t.z : 1 - t.z);
  }
  return share;
}

}  // namespace limber
