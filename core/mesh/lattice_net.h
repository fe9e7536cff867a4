// SPDX-License-Identifier: AGPL-3.0-or-later
// Fits a surface net over a lattice (surface_net.h) to a body's voxels, and fills it with the lattice's tets.
//
// Every sample of the lattice has a region: soft tissue, one of the bones of a rig, or air. The net's points on lattice
// edges are at the border between the voxels of two regions, and the net encloses the same volume as the tissue. So
// some tissue voxels are outside the surface, as many as there are air voxels inside. If tissue voxels are further out
// than kNearVoxels, nearby points of the net are pushed outwards. If that is not enough, the samples around these
// voxels become tissue, until the surface is near the voxels. Two bones never share a cell: between them is at least
// one cell of soft tissue, so no node belongs to two bones.
#pragma once

#include <array>
#include <vector>

#include "core/base/progress.h"
#include "core/mesh/voxel_regions.h"

namespace limber {

// A tissue voxel outside the mesh must have a tissue voxel inside it within this distance, voxels. The voxel outside
// then moves with the mesh's border.
inline constexpr int kNearVoxels = 2;

struct LatticeNet {
  RegionSurface surface;
  TetMesh mesh;  // tets inside the surface; the first nodes are those of the surface
  // The corners of the box (in lattice axes, mm) in which each node of the surface may move without making triangles
  // cross. world_from_lattice rotates and translates; it does not scale.
  Eigen::MatrixX3d low, high;
  AffineTransform world_from_lattice;
  // Triangles of the surface, as their three nodes, at which seams separate the tissue on both sides.
  std::vector<std::array<int, 3>> cut;
  double spacing_mm = 0;  // the spacing in use, which may be larger than requested
  double covered = 0;     // share of tissue voxels inside the surface
  double near = 0;        // share of tissue voxels inside the surface or within kNearVoxels of voxels inside
};

// Returns the surface net and its tets; both are empty for a body without voxels.
//   throws Cancelled
LatticeNet lattice_net(const VoxelRegions& voxels, const LatticeNetSettings& settings = {},
                       Progress& progress = no_progress());

}  // namespace limber
