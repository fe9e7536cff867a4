// SPDX-License-Identifier: AGPL-3.0-or-later
// Cuts a tet mesh open along seams: where a seam separates tissue that touches at rest, each side gets nodes of its
// own, so that the two sides can move apart.
#pragma once

#include <vector>

#include "core/mesh/surface_net.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

// Splits the nodes on seams and returns all of them. Two tets at a node are in one group if they are connected around
// the node through faces that no seam cuts. The first group keeps the node; every further group gets a copy of it, at
// the end of mesh.V.
//   mesh  the tets of `net` (SurfaceNet::tets())    lattice  the lattice of the net, with its seams
std::vector<int> split_at_seams(TetMesh& mesh, const SampleLattice& lattice, const SurfaceNet& net);

}  // namespace limber
