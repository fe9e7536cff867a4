// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds where the mesh of a solve must be cut open along seams (seam sides: lattice_net.h).
//
// The cells of the lattice are far larger than voxels, so the faces between voxels around an edge of the lattice vote
// whether a seam separates the tissue of two sides there.
#pragma once

#include <array>
#include <vector>

#include "core/mesh/surface_net.h"

namespace limber {

// Returns the triangles of the net, each as its three nodes, at which the two sides are to be cut apart.
//   voxels  with sides
std::vector<std::array<int, 3>> faces_at_seams(const VoxelRegions& voxels, const SampleLattice& lattice,
                                               const SurfaceNet& net);

}  // namespace limber
