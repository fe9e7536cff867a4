// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the grid of a posed volume. The grid has the direction of the input grid and is aligned to it; the spacing
// is that of the input unless the caller asks for another. The grid covers the posed tissue and, on each side, as much
// air as the input has there. So the rest pose keeps the grid exactly, and no tissue is dropped.
#pragma once

#include "core/deform/posed_tets.h"

namespace limber {

struct OutputGrid {
  Grid grid;
  VoxelRange range;  // the grid's voxels, in voxel coordinates of OutputLattice (deform/lattice.h)
};

// Returns the grid that holds all posed tissue.
//   tets  the posed tets that contain part of the tissue; nullptr: posed without finite elements
// throws Error when the posed tissue needs a grid above the limit on output voxels
OutputGrid output_grid(const PosedLattice& lattice, const RigidBones& bones, const PosedTets* tets = nullptr);

// Returns input spacing / output spacing along each axis; exactly 1 where they are equal.
glm::dvec3 spacing_ratio(const Grid& grid, double spacing);

}  // namespace limber
