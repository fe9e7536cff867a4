// SPDX-License-Identifier: AGPL-3.0-or-later
// The inverse map: for each voxel of a tile of the output, the rest point it is the image of. It exists only in tiles,
// one per running thread, each filled by the cells that reach it in the order of the cells.
//
// Where two cells claim a voxel, in this order:
//   the cell that is not inverted;
//   the cell whose tissue has the higher priority (bone first);
//   the rest point that lies deeper below air, so that the cut in a fold runs down its middle;
//   the cell with the smaller index.
// Only cells that are no neighbours at rest (share no corner) count as overlap.
//
// Bones are painted rigidly, over whatever the cells say: cells at a bone's border share corners with soft tissue and
// would bend it. A voxel is painted where a rig bone's own motion, read backward, leads to bone tissue of that rig
// bone.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/deform/depth.h"
#include "core/deform/lattice.h"
#include "core/deform/rasterize.h"
#include "core/volume/label_sampler.h"

namespace limber {

struct InverseMap {
  static constexpr std::uint32_t kNoCell = 0xffffffff;
  static constexpr std::uint16_t kNoBone = 0xffff;
  enum Flag : std::uint8_t { kInverted = 1, kOverlap = 2, kBoneOverlap = 4 };

  VoxelRange range;                 // of the posed lattice
  std::vector<glm::vec3> rest;      // rest point
  std::vector<std::uint32_t> cell;  // place in the rest grid of the voxel whose cell covers it, kNoCell outside all
  std::vector<std::uint16_t> bone;  // the rig bone that paints it, kNoBone where none does
  std::vector<std::uint8_t> flags;
  bool has_volume_ratio = true;       // whether it is wanted
  std::vector<float> posed_per_rest;  // volume ratio of the map
  std::vector<Label> lost;            // of each claim that a cell lost to one that is no neighbour
  RowSet row_used;                    // whether any voxel of the row is covered; the other rows are clear

  // An empty map of that range.
  void reset(const VoxelRange& new_range);
  void use_row(const glm::ivec3& voxel) {
    row_used[voxel.y - range.low.y + std::int64_t{range.high.y - range.low.y + 1} * (voxel.z - range.low.z)] = 1;
  }
  std::int64_t count() const { return std::ssize(cell); }
  bool is_covered(std::int64_t i) const { return (cell[i] != kNoCell) | (bone[i] != kNoBone); }
  std::int64_t index(const glm::ivec3& voxel) const {
    const glm::ivec3 v = voxel - range.low, size = range.high - range.low + 1;
    return v.x + std::int64_t{size.x} * (v.y + std::int64_t{size.y} * v.z);
  }
};

// Some of the tissue: by brick, as the brick's own mask.
using TissueMask = std::vector<std::array<std::uint64_t, 8>>;

// Writes the claims of the cells of `bricks` (rising) into the map.
//   priority  of the tissue, per label       depth  nullptr where no pose can make a fold
//   without   cells that something else carries, or nullptr
void rasterize_cells(InverseMap& map, const PosedLattice& lattice, const std::vector<std::int64_t>& bricks,
                     const std::vector<int>& priority, const TissueDepth* depth, const TissueMask* without = nullptr);

// Bone tissue that moves rigidly.
class RigidBones {
 public:
  // Where a rig bone's bone tissue lies in one brick, grown by one voxel: as far as its membership reaches.
  struct Piece {
    int bone;
    std::int64_t brick;
    VoxelRange rest;
    VoxelRange posed;          // voxels of the posed lattice that its image can reach
    VoxelRange posed_centres;  // voxels whose centres lie in the box of the image of the bone voxels themselves
  };

  // Every bone tissue voxel follows the first bone of its influence alone.
  //   is_bone  per label; all zero when the volume has no bone tissue
  RigidBones(const PosedLattice& lattice, const SkinWeights& weights, const LabelSet& is_bone,
             const std::vector<RigidTransform>& posed_from_rest);

  const std::vector<Piece>& pieces() const { return pieces_; }
  // The rest point that the bone's motion carries to a posed voxel.
  glm::dvec3 rest_point(int bone, const glm::dvec3& posed) const;
  // Distance in mm between a posed voxel and where the bone's motion carries a rest point.
  double residual(int bone, const glm::dvec3& rest, const glm::dvec3& posed) const;
  // The rig bone of a voxel of bone tissue, -1 elsewhere.
  int owner(const glm::ivec3& voxel) const;
  // 1 + the rig bone of every voxel of bone tissue at rest, 0 elsewhere.
  LabelVolume numbered() const;
  RowSet rest_rows() const;  // of the rest volume that may hold bone tissue
  // Whether bone tissue of this rig bone is what the rest volume has there.
  bool has(int bone, const glm::dvec3& rest, const LabelSampler& sampler, bool nearest) const;

  // Writes the bones of `pieces` into the map.
  void paint(InverseMap& map, const std::vector<std::int64_t>& pieces, const LabelSampler& sampler, bool nearest,
             const TissueDepth* depth) const;

 private:
  void find_pieces();
  std::pair<glm::dvec3, glm::dvec3> posed_box(int bone, const VoxelRange& voxels) const;

  const PosedLattice* lattice_;
  const SkinWeights* weights_;
  const LabelSet* is_bone_;
  std::vector<AffineTransform> rest_shift_;   // rest point - posed point in rest voxel coordinates, of the posed point
  std::vector<AffineTransform> posed_shift_;  // posed point - rest point, of the rest point
  std::vector<Piece> pieces_;
};

}  // namespace limber
