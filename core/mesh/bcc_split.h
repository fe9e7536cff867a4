// SPDX-License-Identifier: AGPL-3.0-or-later
// Tetrahedra of a body without any library and without a way to fail: every lattice cell that holds a voxel is solid and is
// split around its centre. Two neighbours of one region share four tets that stand across their common face, as in the
// body-centred cubic lattice; where the region changes, each side has four of its own. No dihedral angle is below 45 degrees.
// The surface is as rough as the cells.
#pragma once

#include "core/mesh/lattice_net.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

//   spacing_mm  of cells; made larger where there would be more than 12 million samples
// Bones never touch: between two of them is at least a cell of soft tissue. No tets for a body without voxels.
TetMesh bcc_split(const VoxelRegions& voxels, double spacing_mm);

}  // namespace limber
