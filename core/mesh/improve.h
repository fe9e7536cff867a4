// SPDX-License-Identifier: AGPL-3.0-or-later
// Better tets by moving nodes [Freitag & Ollivier-Gooch, Tetrahedral mesh improvement using swapping and smoothing,
// 1997]: each node of a flat tet goes where the smallest angle around it is largest. Nodes of the surface stay in their
// box of the lattice, so that the surface remains one that cannot cross itself; others are free.
#pragma once

#include "core/mesh/lattice_net.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

struct ImproveSettings {
  double enough_degrees = 10;  // tets whose smallest dihedral angle is larger are let be
  int sweeps = 12;
  double least_covered = 0.9992;  // share of the tissue voxels that must stay inside
};

// The first #low rows of mesh.V are the net's nodes. The smallest angle around a node never becomes smaller by its
// move. Returns the number of moves.
//   throws Cancelled
int improve(TetMesh& mesh, const LatticeNet& net, const VoxelRegions& voxels, const ImproveSettings& settings = {},
            Progress& progress = no_progress());

}  // namespace limber
