// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the grid of a posed volume. Its direction is the input's, its spacing too unless another is asked for, and
// it is aligned to the input lattice. It is as large as the posed tissue plus the air that the input has on each side.
// So the rest pose keeps the grid exactly, and no voxel is dropped.
#pragma once

#include "core/deform/posed_tets.h"

namespace limber {

struct OutputGrid {
  Grid grid;
  VoxelRange range;  // the grid's voxels, in coordinates of the output lattice
};

// Returns the grid that holds all posed tissue.
//   tets  the posed tets that carry part of the tissue, or nullptr
// throws Error when the posed tissue needs a grid above the limit on output voxels
OutputGrid output_grid(const PosedLattice& lattice, const RigidBones& bones, const PosedTets* tets = nullptr);

// Returns input spacing / output spacing along each axis; exactly 1 where they are equal.
glm::dvec3 spacing_ratio(const Grid& grid, double spacing);

}  // namespace limber
