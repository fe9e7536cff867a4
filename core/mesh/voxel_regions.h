// SPDX-License-Identifier: AGPL-3.0-or-later
// What a mesh is made from: the region of each voxel, the sides of seams, and the settings of the lattice whose samples
// get these regions.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/mesh/tetrahedralize.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

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

}  // namespace limber
