// SPDX-License-Identifier: AGPL-3.0-or-later
// Connected pieces of a list of voxels that are few beside their grid, such as those that a measure found fault with.
#pragma once

#include <cstdint>
#include <vector>

#include "core/volume/grid.h"

namespace limber {

// The pieces of voxels that meet by a face, an edge or a corner (26-connected), the largest first, of equal ones the
// first in the list; each holds places in the list, ascending.
//   voxels  indices into the grid, ascending, none twice
//   reach   along each axis; with 2 or more, voxels also belong together across a gap of one voxel less than that
std::vector<std::vector<std::int64_t>> pieces_of(const Grid& grid, const std::vector<std::int64_t>& voxels,
                                                 const glm::ivec3& reach = glm::ivec3(1));

// The voxel of a piece that lies nearest to the piece's middle.
//   piece  places in `voxels`, at least one
glm::ivec3 middle_voxel(const Grid& grid, const std::vector<std::int64_t>& voxels,
                        const std::vector<std::int64_t>& piece);

inline glm::ivec3 voxel_of_index(const Grid& grid, std::int64_t at) {
  const std::int64_t row = at / grid.size.x;
  return {static_cast<int>(at % grid.size.x), static_cast<int>(row % grid.size.y), static_cast<int>(row / grid.size.y)};
}

}  // namespace limber
