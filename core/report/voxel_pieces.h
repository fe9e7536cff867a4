// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the connected components (pieces) of a list of voxels, such as the voxels that a measure found to be wrong. It
// is meant for lists that are short compared with the number of the grid's voxels.
#pragma once

#include <cstdint>
#include <vector>

#include "core/volume/grid.h"

namespace limber {

// Returns the connected components of the voxels, where voxels that meet by a face, an edge or a corner are connected
// (26-connected). The largest component comes first; equally large ones are in the order of their first voxels. Each
// component is a list of ascending indices into `voxels`.
//   voxels  indices into the grid, ascending and distinct
//   reach   largest offset between two connected voxels, along each axis: 2 connects across a gap of one voxel
std::vector<std::vector<std::int64_t>> pieces_of(const Grid& grid, const std::vector<std::int64_t>& voxels,
                                                 const glm::ivec3& reach = glm::ivec3(1));

// Returns the voxel of a connected component that is nearest to the component's mean position.
//   piece  the component: indices into `voxels`, at least one
glm::ivec3 middle_voxel(const Grid& grid, const std::vector<std::int64_t>& voxels,
                        const std::vector<std::int64_t>& piece);

inline glm::ivec3 voxel_of_index(const Grid& grid, std::int64_t at) {
  const std::int64_t row = at / grid.size.x;
  return {static_cast<int>(at % grid.size.x), static_cast<int>(row % grid.size.y), static_cast<int>(row / grid.size.y)};
}

}  // namespace limber
