// SPDX-License-Identifier: AGPL-3.0-or-later
// A body's surface net over a lattice (surface_net.h), fitted to its voxels, and the lattice's tets inside it.
//
// Every sample of the lattice has a region: soft tissue, one of the bones of a rig, or air. Points of edges lie at the
// true border of the voxels. Voxels that stay outside push the points next to them outwards, and where that is not
// enough the samples around them become tissue, until the surface encloses them. Two bones never share a cell: between
// them is at least a cell of soft tissue, so no node belongs to two bones.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/mesh/tetrahedralize.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// Per tissue voxel its region: TetMesh::kSoft, or 1 + the rig bone it is bone tissue of.
struct VoxelRegions {
  const Grid& grid;
  const TissueVoxels& tissue;
  const std::vector<std::uint16_t>& region;  // #N, brick order
};

struct LatticeNetSettings {
  double spacing_mm = 8;  // of samples near the surface; made larger where there would be more than 12 million
  std::vector<glm::dvec3> fine_around;  // world, mm: joints that bend
  double fine_radius_mm = 40;           // around them samples are half as far apart
  double least_covered = 0.9995;        // share of the voxels whose centre must lie inside
};

struct LatticeNet {
  RegionSurface surface;
  TetMesh mesh;  // inside the surface, whose nodes come first
  // The box (in lattice axes, mm) in which each node of the surface may move without any triangle crossing another.
  // world_from_lattice turns; it does not scale.
  Eigen::MatrixX3d low, high;
  AffineTransform world_from_lattice;
  double spacing_mm = 0;  // as it became
  double covered = 0;     // share of tissue voxels inside
};

// Empty for a body without voxels.
//   throws Cancelled
LatticeNet lattice_net(const VoxelRegions& voxels, const LatticeNetSettings& settings = {},
                       Progress& progress = no_progress());

}  // namespace limber
