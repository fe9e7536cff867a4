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
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/progress.h"
#include "core/mesh/tetrahedralize.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// A tissue voxel outside the mesh must have a tissue voxel inside it within this distance, voxels. The voxel outside
// then moves with the mesh's border.
inline constexpr int kNearVoxels = 2;

// Where seams separate parts of the body, soft tissue has a region by its side of the seams: TetMesh::kSoft on side 0,
// kSide + s on side s > 0. The surface net then also separates the sides.
inline constexpr std::uint16_t kSide = 0x4000;
inline std::uint16_t soft_region(std::uint16_t side) {
  return side == 0 ? TetMesh::kSoft : static_cast<std::uint16_t>(kSide + side);
}
inline bool is_soft_region(std::uint16_t region) {
  return region == TetMesh::kSoft || (region > kSide && region != RegionSurface::kAir);
}

// On which side of seams each part of a body lies.
struct SeamSides {
  std::vector<std::uint16_t> of_bone;  // side of each rig bone, from 0; empty: no seam separates tissue
  // The seams along which tissue of different sides is cut apart. Null: no seam separates tissue.
  std::shared_ptr<const Seams> seams;
};

// The region of each tissue voxel: that of soft tissue, or 1 + the index of the rig bone to which the voxel belongs.
struct VoxelRegions {
  const Grid& grid;
  const TissueVoxels& tissue;
  const std::vector<std::uint16_t>& region;  // region of each tissue voxel, in brick order
  const SeamSides* sides = nullptr;          // the sides of seams; null: no sides

  // Returns the side of the seams on which tissue of a region lies.
  std::uint16_t side_of(std::uint16_t of) const {
    if (is_soft_region(of)) return of == TetMesh::kSoft ? 0 : static_cast<std::uint16_t>(of - kSide);
    return sides ? sides->of_bone[TetMesh::bone_of(of)] : std::uint16_t{0};
  }
};

struct LatticeNetSettings {
  // The distance between samples near the surface. It is increased if there would be more than 12 million samples.
  double spacing_mm = 8;
  std::vector<glm::dvec3> fine_around;  // positions of joints that bend, world, mm
  // Within this distance of the joints in fine_around, samples are half as far apart.
  double fine_radius_mm = 40;
  // Near these places bones keep away from the surface by a cell at least, so that tissue over them can slide: the
  // samples of bone next to air become soft tissue.
  struct Covered {
    glm::dvec3 place;  // position at rest over which tissue slides, world, mm
    double mm;         // distance from it up to which bones are covered
  };
  std::vector<Covered> covered;
  double least_near = 0.9995;  // share of the tissue voxels that must be inside the surface or within kNearVoxels of it
};

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
