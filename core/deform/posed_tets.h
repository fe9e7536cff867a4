// SPDX-License-Identifier: AGPL-3.0-or-later
// Tissue that a tet mesh carries, posed. Where PosedLattice makes a cell of every tissue voxel, here the mesh's tets
// are the cells: each posed voxel centre in a tet is the image of the rest point that the tet's affine map gives, and
// belongs to the tissue voxel that this point lies in; where it lies in air, so does its image. Tets are rasterized by
// the same exact half-open rule (rasterize.h), after rounding to the same fixed point, so the rest pose is exact.
//
// A mesh follows the tissue's border only nearly. Tissue voxels in the mesh's charge that stick out of it, by their
// centre or by a corner, ride on it as cubes of their own: a corner inside goes with its tet, a corner outside with the
// nearest point of the mesh's border, turned by the rotation of the tet there, and nearer to it than at rest where
// another part of the mesh has come near: what sticks out of skin that is pressed against skin is pressed flat. Riders
// write only where no tet did.
//
// A mesh need not hold the whole body. Tissue outside its charge is the lattice's, as ever. So is one layer of voxels
// on the mesh's side of where the two meet: they move alike there, and no rounding opens a gap.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/deform/box_bins.h"
#include "core/deform/inverse_map.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

class PosedTets {
 public:
  // Keeps references: mesh and lattice must outlive it.
  //   posed     #V by 3, world, mm
  //   lattice   tells volume, tissue and output; its own cells are not asked
  //   in_mesh   tissue voxels that are the mesh's charge
  // throws Error when the mesh is carried further than 32 000 output voxels or to a place that is not finite
  PosedTets(const TetMesh& mesh, const Eigen::MatrixX3d& posed, const PosedLattice& lattice, TissueMask in_mesh,
            Progress& progress = no_progress());

  // The cells that the lattice leaves out.
  const TissueMask& instead_of() const { return instead_of_; }
  std::int64_t rider_count() const { return std::ssize(riders_); }
  // Whether any of the brick's tissue is the mesh's charge.
  bool shares(std::int64_t brick) const { return in_mesh_[brick] != std::array<std::uint64_t, 8>{}; }
  // Voxels of the output whose centres lie in the box of the posed tissue of the bricks that it shares.
  const VoxelRange& posed_tissue() const { return posed_tissue_; }

  // Writes the claims of the tets into the map.
  void rasterize(InverseMap& map, const std::vector<int>& priority, const TissueDepth* depth) const;
  // Writes the riders where the map is still empty: after everything else.
  void rasterize_riders(InverseMap& map, const std::vector<int>& priority, const TissueDepth* depth) const;
  bool reaches(const VoxelRange& range) const;

 private:
  struct Rider {
    glm::ivec3 voxel;
    std::array<FixedPoint, 8> corners;  // bit 0 of the index is x, bit 1 y, bit 2 z
  };
  struct BrickOutcome;
  class Border;

  void place_nodes();
  void run_brick(std::int64_t brick, const BoxBins& rest_bins, const Border& border, BrickOutcome& outcome) const;
  bool is_in_mesh(const glm::ivec3& voxel) const;
  void find_instead_of();
  FixedPoint carried(int tet, const glm::dvec3& rest) const;
  FixedPoint fixed(const glm::dvec3& output) const;
  std::array<FixedPoint, 4> posed_corners(int tet) const;
  std::array<glm::dvec3, 4> rest_corners(int tet) const;

  const TetMesh* mesh_;
  const PosedLattice* lattice_;
  TissueMask in_mesh_, instead_of_;
  std::vector<glm::dvec3> rest_;   // #V voxel coordinates at rest, whole numbers of 1/65536
  std::vector<FixedPoint> posed_;  // #V
  Eigen::MatrixX3d moved_;         // #V posed - rest, world, mm
  BoxBins bins_, rider_bins_;      // of the output
  std::vector<Rider> riders_;
  VoxelRange posed_tissue_;
};

}  // namespace limber
