// SPDX-License-Identifier: AGPL-3.0-or-later
// Visits the voxels whose centres are in a tet, row by row. A centre on a face counts as inside, even if rounding puts
// it slightly (1e-7 voxel) outside.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/mesh/tet_mesh.h"
#include "core/volume/grid.h"

namespace limber {

inline constexpr double kHair = 1e-7;  // tolerance at a tet's faces, voxels

// Calls body(first, last) with the first and last voxel of each row along x that are inside the tet and the grid.
//   corner                   corners of a positively oriented tet, voxel coordinates
//   first_slice, last_slice  range of z
template <class Body>
void for_each_row_in_tet(const glm::dvec3 (&corner)[4], const Grid& grid, int first_slice, int last_slice,
                         const Body& body) {
  glm::dvec3 low = corner[0], high = corner[0], outwards[4];
  for (const auto& c : corner) low = glm::min(low, c), high = glm::max(high, c);
  for (int i = 0; i < 4; ++i) {
    const glm::dvec3& a = corner[kTetFaces[i][0]];
    outwards[i] = glm::cross(corner[kTetFaces[i][1]] - a, corner[kTetFaces[i][2]] - a);
  }
  for (int z = std::max(first_slice, int(std::ceil(low.z - kHair)));
       z <= std::min(last_slice, int(std::floor(high.z + kHair))); ++z)
    for (int y = std::max(0, int(std::ceil(low.y - kHair)));
         y <= std::min(grid.size.y - 1, int(std::floor(high.y + kHair))); ++y) {
      double from = 0, to = grid.size.x - 1.0;
      for (int i = 0; i < 4; ++i) {  // points p inside: outwards . (p - a) <= kHair * |outwards|
        const glm::dvec3& a = corner[kTetFaces[i][0]];
        const double rest = outwards[i].y * (y - a.y) + outwards[i].z * (z - a.z) - outwards[i].x * a.x -
                            kHair * glm::length(outwards[i]);
        if (outwards[i].x > 0) to = std::min(to, -rest / outwards[i].x);
        else if (outwards[i].x < 0) from = std::max(from, -rest / outwards[i].x);
        else if (rest > 0) to = -1;
      }
      const double first = std::ceil(from), last = std::floor(to);
      if (first <= last) body(glm::ivec3(int(first), y, z), glm::ivec3(int(last), y, z));
    }
}

}  // namespace limber
