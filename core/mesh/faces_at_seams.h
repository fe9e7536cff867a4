// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds and smooths the triangles along which the mesh of a solve is cut open at seams (SeamSides: voxel_regions.h).
//
// The cells of the lattice are far larger than voxels, so the faces between voxels around an edge of the lattice vote
// whether a seam separates the tissue of two sides there.
#pragma once

#include <array>
#include <vector>

#include "core/mesh/lattice_net.h"
#include "core/mesh/surface_net.h"

namespace limber {

// Returns the triangles of the net, each as its three nodes, at which the two sides are to be cut apart.
//   voxels  with sides
std::vector<std::array<int, 3>> faces_at_seams(const VoxelRegions& voxels, const SampleLattice& lattice,
                                               const SurfaceNet& net);

// Smooths the triangles of the net along which the mesh is cut (LatticeNet::cut). The steps of voxels and slices would
// interlock like teeth, and the two sides could not slide along each other. Nodes stay in their boxes; nodes that also
// belong to other triangles, such as those of the skin, stay where they are.
void smooth_seams(LatticeNet& net);

}  // namespace limber
