// SPDX-License-Identifier: AGPL-3.0-or-later
// Poses tissue that moves with a tet mesh. In PosedLattice every tissue voxel is a cell; here the mesh's tets are the
// cells. The inverse of a tet's affine map gives the rest point of each voxel centre that the posed tet contains. The
// voxel gets the label of the voxel that contains this rest point; if that is air, the tet does not claim the voxel.
// Tets are rasterized by the exact half-open rule of rasterize.h, after rounding to fixed point as in lattice.h, so the
// rest pose is exact.
//
// A mesh follows the tissue's border only approximately. Tissue voxels of the mesh whose centre or a corner is outside
// the mesh are *riders*, which are posed as separate cubes. A corner inside the mesh moves with its tet. A corner
// outside moves with the nearest point of the mesh's border and rotates with the tet there. If another part of the mesh
// comes near, the corner is moved closer to the border than at rest: where skin presses on skin, tissue outside the
// border is flattened. Riders fill only voxels that no tet covers. A rider whose voxel is already covered counts as an
// overlap, unless the two were within a few voxels of each other at rest, on both sides of a crease, where the fold
// presses them together.
//
// A mesh that is cut along seams (TetMesh::side) follows the seams, too, only approximately. A voxel inside a tet of
// the other side is a rider as well, and all corners of a rider move with the side on which the voxel lies. Where two
// sides are attached to each other, voxels move with the tets around them, whatever their side.
//
// Where flesh slides over bone, tets of flesh may enter those of the bone by a little. There the bone's tets fill only
// voxels that no other tet covers, and this counts as no overlap.
//
// A mesh need not contain the whole body. The lattice (lattice.h) poses all other tissue. It also poses the layer of
// the mesh's voxels next to that tissue: there lattice and mesh have the same motion, so no rounding error opens a gap.
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
  // Keeps references to `mesh` and `lattice`, which must outlive this object.
  //   posed     #V by 3 posed nodes, world, mm
  //   lattice   gives the volume, its tissue and the output lattice
  //   in_mesh   tissue voxels that move with the mesh
  //   side      #tissue voxels, in brick order: on which side of seams each lies; null: the mesh is not cut along seams
  //   throws Error if the pose moves the mesh further than 32 000 output voxels or to a position that is not finite
  PosedTets(const TetMesh& mesh, const Eigen::MatrixX3d& posed, const PosedLattice& lattice, TissueMask in_mesh,
            Progress& progress = no_progress(), const std::vector<std::uint16_t>* side = nullptr);

  // Returns the voxels that the lattice must not pose because they move with the mesh.
  const TissueMask& instead_of() const { return instead_of_; }
  struct Rider {
    glm::ivec3 voxel;
    std::array<FixedPoint, 8> corners;  // posed corners; bits 0, 1, 2 of the index are x, y, z
  };
  const std::vector<Rider>& riders() const { return riders_; }
  std::int64_t rider_count() const { return std::ssize(riders_); }
  // Returns true if any of the brick's tissue moves with the mesh.
  bool shares(std::int64_t brick) const { return in_mesh_[brick] != std::array<std::uint64_t, 8>{}; }
  // Returns the range of output voxels that the posed tissue of all bricks with shares() can reach.
  const VoxelRange& posed_tissue() const { return posed_tissue_; }

  // Writes the output voxels that the posed tets cover into the map.
  void rasterize(InverseMap& map, const std::vector<int>& priority, const TissueDepth* depth) const;
  // Writes the riders (tissue voxels that stick out of the mesh, posed as separate cubes) into the voxels of the map
  // that are still empty. Must be called last.
  void rasterize_riders(InverseMap& map, const std::vector<int>& priority, const TissueDepth* depth) const;
  bool reaches(const VoxelRange& range) const;

 private:
  struct BrickOutcome;
  class Border;
  static constexpr int kCorners = TissueVoxels::kBrick + 1;            // number of corners along the edge of a brick
  using CornerTets = std::array<int, kCorners * kCorners * kCorners>;  // a tet for each corner; -1: none

  void place_nodes();
  void run_brick(std::int64_t brick, const BoxBins& rest_bins, const Border& border, BrickOutcome& outcome) const;
  Rider on_side(int side, Rider rider, const CornerTets& tet_of, const Border& border) const;
  bool lies_across(std::int64_t place, const glm::ivec3& voxel, int home, const Border& border) const;
  bool is_in_mesh(const glm::ivec3& voxel) const;
  bool is_across(const glm::ivec3& voxel) const;
  void find_instead_of();
  FixedPoint carried(int tet, const glm::dvec3& rest) const;
  FixedPoint fixed(const glm::dvec3& output) const;
  std::array<FixedPoint, 4> posed_corners(int tet) const;
  std::array<glm::dvec3, 4> rest_corners(int tet) const;

  const TetMesh* mesh_;
  const PosedLattice* lattice_;
  TissueMask in_mesh_, instead_of_;
  const std::vector<std::uint16_t>* side_;  // #tissue voxels: side of seams; null: the mesh is not cut along seams
  TissueMask across_;                       // tissue voxels inside tets of the other side of a seam; empty: no sides
  std::vector<char> is_slid_over_;          // #T: 1 for tets of bone over which flesh slides
  std::vector<glm::dvec3> rest_;            // #V node positions at rest, voxel coordinates, rounded to 1/65536
  std::vector<FixedPoint> posed_;           // #V posed node positions
  Eigen::MatrixX3d moved_;                  // #V motions of the nodes (posed - rest), world, mm
  BoxBins bins_, rider_bins_;               // posed bounding boxes of the tets and of the riders, in output voxels
  std::vector<Rider> riders_;
  VoxelRange posed_tissue_;
};

}  // namespace limber
