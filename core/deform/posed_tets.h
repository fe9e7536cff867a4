// SPDX-License-Identifier: AGPL-3.0-or-later
// Poses tissue that a tet mesh carries. In PosedLattice every tissue voxel is a cell; here the mesh's tets are the
// cells. Each posed voxel centre in a tet is the image of a rest point, which the tet's affine map gives. The posed
// voxel gets the tissue of the voxel around that rest point; if that voxel is air, the tet does not claim it. Tets are
// rasterized by the exact half-open rule of rasterize.h, after rounding to fixed point as in lattice.h, so the rest
// pose is exact.
//
// A mesh follows the tissue's border only approximately. Tissue voxels of the mesh whose centre or a corner lies
// outside it are *riders*, which are posed as separate cubes. A corner inside the mesh moves with its tet. A corner
// outside moves with the nearest point of the mesh's border and rotates with the tet there. If another part of the mesh
// has come near, it moves closer to the border than at rest: tissue outside the border is pressed flat where skin
// presses on skin. Riders fill only voxels that no tet covers. A rider whose voxel is taken counts as an overlap,
// unless both lay within a few voxels of each other at rest, on either side of a crease: there the fold squeezes them
// together.
//
// A mesh need not contain the whole body. The lattice (lattice.h) carries all other tissue. It also carries one layer
// of voxels of the mesh next to that tissue: lattice and mesh move equally there, and no rounding error opens a gap.
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
  // Keeps references: mesh and lattice must outlive this object.
  //   posed     #V by 3 posed nodes, world, mm
  //   lattice   gives the volume, its tissue and the output lattice
  //   in_mesh   tissue voxels that the mesh carries
  //   throws Error if the pose moves the mesh further than 32 000 output voxels or to a position that is not finite
  PosedTets(const TetMesh& mesh, const Eigen::MatrixX3d& posed, const PosedLattice& lattice, TissueMask in_mesh,
            Progress& progress = no_progress());

  // Returns the cells that the lattice must not pose because the mesh carries them.
  const TissueMask& instead_of() const { return instead_of_; }
  std::int64_t rider_count() const { return std::ssize(riders_); }
  // Returns whether the mesh carries any of the brick's tissue.
  bool shares(std::int64_t brick) const { return in_mesh_[brick] != std::array<std::uint64_t, 8>{}; }
  // Returns the range of output voxels that the posed tissue can reach, for all bricks with tissue that the mesh
  // carries.
  const VoxelRange& posed_tissue() const { return posed_tissue_; }

  // Enters the output voxels that the posed tets cover into the map.
  void rasterize(InverseMap& map, const std::vector<int>& priority, const TissueDepth* depth) const;
  // Enters the riders (tissue voxels that stick out of the mesh, posed as separate cubes) into the map where it is
  // still empty. Call it after everything else is entered.
  void rasterize_riders(InverseMap& map, const std::vector<int>& priority, const TissueDepth* depth) const;
  bool reaches(const VoxelRange& range) const;

 private:
  struct Rider {
    glm::ivec3 voxel;
    std::array<FixedPoint, 8> corners;  // posed corners; bits 0, 1, 2 of the index are x, y, z
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
  std::vector<glm::dvec3> rest_;   // #V node positions at rest, voxel coordinates, whole numbers of 1/65536
  std::vector<FixedPoint> posed_;  // #V posed node positions
  Eigen::MatrixX3d moved_;         // #V motions of the nodes (posed - rest), world, mm
  BoxBins bins_, rider_bins_;      // posed bounding boxes of the tets and of the riders, in output voxels
  std::vector<Rider> riders_;
  VoxelRange posed_tissue_;
};

}  // namespace limber
