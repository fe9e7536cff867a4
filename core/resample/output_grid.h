// SPDX-License-Identifier: AGPL-3.0-or-later
// The grid of a posed volume: spacing and direction as before (or another spacing), aligned to the input lattice, as
// large as the posed tissue plus the air that the input had on each side. So the rest pose keeps the grid exactly, and
// no voxel is dropped.
#pragma once

#include "core/deform/posed_tets.h"

namespace limber {

struct OutputGrid {
  Grid grid;
  VoxelRange range;  // of the posed lattice
};

// throws Error when the posed tissue needs an absurdly large grid
//   tets  carry part of the tissue, or nullptr
OutputGrid output_grid(const PosedLattice& lattice, const RigidBones& bones, const PosedTets* tets = nullptr);

// input spacing / output spacing; exactly 1 where they are equal
glm::dvec3 spacing_ratio(const Grid& grid, double spacing);

}  // namespace limber
