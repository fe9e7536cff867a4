// SPDX-License-Identifier: AGPL-3.0-or-later
// Cuts a tet mesh open along seams: where a seam separates tissue that touches at rest, each side gets nodes of its
// own, so that the two sides can move apart.
#pragma once

#include <array>
#include <vector>

#include "core/mesh/surface_net.h"
#include "core/mesh/tet_mesh.h"
#include "core/mesh/voxel_regions.h"

namespace limber {

// Gives the nodes of the given faces copies, as split_at_seams() does. Returns the nodes of which the new nodes at the
// end of mesh.V are copies.
//   faces  faces between two tets, each as its three nodes
//   nodes  further nodes to split: those at which only an edge or the node itself connects tets
std::vector<int> split_at_faces(TetMesh& mesh, const std::vector<std::array<int, 3>>& faces,
                                const std::vector<int>& nodes = {});

// Moves the two sides of the faces apart after split_at_faces(): every node that was split moves into its own side, by
// `mm` or by less where a tet would lose more than half of its volume. So contact can keep the sides apart.
//   faces  the faces before the split    before  the tets before the split
void open_faces(TetMesh& mesh, const std::vector<std::array<int, 3>>& faces, const Eigen::MatrixX4i& before, double mm);

// Removes tets of soft tissue at the border whose triangles cross others, as may remain after open_faces() where the
// faces fold sharply. Their tissue then moves with the border. Returns the number of removed tets.
//   mesh  regions by sides (soft_region()); a removed tet leaves its nodes
std::int64_t remove_crossing(TetMesh& mesh);

// Removes flakes: parts of the mesh without bone, connected to no other part, in which tissue is less than half of the
// volume. The mesh is coarser than the body, so it may bridge the air between two limbs; where the bridge is cut
// between their sides, flakes remain that nothing holds in place. Returns the number of removed tets.
//   mesh  regions by sides (soft_region()); a removed tet leaves its nodes
std::int64_t remove_flakes(TetMesh& mesh, const VoxelRegions& voxels);

// Splits the nodes on seams and returns all of them. Two tets at a node are in one group if they are connected around
// the node through faces that no seam cuts. The first group keeps the node; every further group gets a copy of it, at
// the end of mesh.V.
//   mesh  the tets of `net` (SurfaceNet::tets())    lattice  the lattice of the net, with its seams
std::vector<int> split_at_seams(TetMesh& mesh, const SampleLattice& lattice, const SurfaceNet& net);

}  // namespace limber
