// SPDX-License-Identifier: AGPL-3.0-or-later
// Searches the ball of voxels around a voxel for one that passes a test.
#pragma once

#include "core/volume/grid.h"

namespace limber {

// Returns true if passes(voxel) is true for at least one voxel of the grid at most `radius` voxels away from `centre`.
template <class Passes>
bool any_voxel_near(const glm::ivec3& centre, const Grid& grid, int radius, const Passes& passes) {
  glm::ivec3 off;
  for (off.z = -radius; off.z <= radius; ++off.z)
    for (off.y = -radius; off.y <= radius; ++off.y)
      for (off.x = -radius; off.x <= radius; ++off.x)
        if (off.x * off.x + off.y * off.y + off.z * off.z <= radius * radius && grid.contains(centre + off) &&
            passes(centre + off))
          return true;
  return false;
}

}  // namespace limber
