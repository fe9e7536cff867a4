// SPDX-License-Identifier: AGPL-3.0-or-later
// The surface of a body's regions (soft tissue, the bones of a rig, air) as triangles that cannot cut themselves: a dual
// surface net over a lattice of samples [Gibson, MICCAI 1998], made free of intersections by fans [Ju & Udeshi,
// Intersection-free contouring on an octree grid, Pacific Graphics 2006].
//
// Every sample of the lattice has a region. A cell with samples of two regions gets one vertex strictly inside it; around
// every lattice edge between two regions a face joins the vertices of the cells there, as a fan around a point of the
// edge. Inside a cell all triangles are cones from its vertex, so none can cross another wherever the vertices lie.
// Where cells of two sizes meet (fine ones, half as large, around the joints that bend) the fan also passes a point of the
// face between them, so that the surface has no crack.
//
// Points of edges lie at the true border of the voxels. Voxels that stay outside push the points next to them outwards, and where
// that is not enough the samples around them become tissue, until the surface encloses them. Two bones never share a
// cell: between them is at least a cell of soft tissue, so no node belongs to two bones.
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

enum class NetShape {
  fitted,  // at the voxels' border
  plain,   // every point in the middle of its cell, face or edge: coarser, but as regular as can be
};

struct LatticeNetSettings {
  double spacing_mm = 8;                 // of samples; made larger where there would be more than 12 million
  std::vector<glm::dvec3> fine_around;   // world, mm: joints that bend
  double fine_radius_mm = 40;            // around them samples are half as far apart
  NetShape shape = NetShape::fitted;
  double least_covered = 0.9995;         // share of the voxels whose centre must lie inside
};

struct LatticeNet {
  RegionSurface surface;
  // The box (in lattice axes, mm) in which each node may move without any triangle crossing another. lattice_from_world
  // turns; it does not scale.
  Eigen::MatrixX3d low, high;
  AffineTransform world_from_lattice;
  double spacing_mm = 0;  // as it became
  double covered = 0;     // share of tissue voxels inside
};

// Empty for a body without voxels.
//   throws Cancelled
LatticeNet lattice_net(const VoxelRegions& voxels, const LatticeNetSettings& settings = {}, Progress& progress = no_progress());

}  // namespace limber
