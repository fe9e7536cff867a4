// SPDX-License-Identifier: AGPL-3.0-or-later
// Cuts a tet mesh open along seams: where a seam separates tissue that touches at rest, each side gets nodes of its
// own, so that the two sides can move apart.
#pragma once

#include <vector>

#include "core/mesh/surface_net.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

// Gives each node on a seam one copy for each further group of its tets: tets are in one group if faces that no seam
// cuts connect them around the node. New nodes are added at the end of mesh.V. Returns all nodes on seams.
//   mesh  the tets of `net` (SurfaceNet::tets())    lattice  the lattice of the net, with its seams
std::vector<int> split_at_seams(TetMesh& mesh, const SampleLattice& lattice, const SurfaceNet& net);

}  // namespace limber
