// SPDX-License-Identifier: AGPL-3.0-or-later
// Improves tets by moving their nodes [Freitag & Ollivier-Gooch, Tetrahedral mesh improvement using swapping and
// smoothing, 1997]: each node of a flat tet moves to the position that maximizes the smallest dihedral angle around the
// node. Nodes of the surface stay in their boxes (LatticeNet::low, high), so that the surface still cannot cross
// itself, and nodes of the skin stay close to the surface that was fitted to the voxels; other nodes move freely.
#pragma once

#include "core/mesh/lattice_net.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

struct ImproveSettings {
  double enough_degrees = 10;  // tets whose smallest dihedral angle is larger are not changed
  int sweeps = 12;
};

// Moves the nodes of flat tets and returns the number of moves. A move never reduces the smallest dihedral angle around
// its node.
//   mesh  its first nodes are those of the net's surface, in the same order (one per row of net.low)
//   throws Cancelled
int improve(TetMesh& mesh, const LatticeNet& net, const ImproveSettings& settings = {},
            Progress& progress = no_progress());

}  // namespace limber
