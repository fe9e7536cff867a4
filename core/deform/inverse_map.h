// SPDX-License-Identifier: AGPL-3.0-or-later
// The inverse map: for each voxel of a tile of the output, the rest point that the pose moves to the voxel. Only one
// tile per running thread is in memory. A cell (posed image of a rest voxel or tet) claims the voxels whose centres it
// covers. The cells that reach a tile fill it in ascending order.
//
// If two cells claim a voxel, these rules decide, in this order:
//    the cell that is not inverted wins;
//    the cell whose tissue has the higher priority wins (bone first);
//    the rest point that lies deeper below air wins, so that the cut in a fold runs down its middle;
//    the cell with the smaller index wins.
// Two cells overlap only if they are not neighbours at rest (share no corner).
//
// Bones are painted over the cells afterwards, with their rigid motions, because cells at a bone's border share corners
// with soft tissue and would bend the bone. A voxel is painted with a rig bone's tissue if the inverse of the bone's
// motion moves the voxel to tissue of this bone.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/deform/depth.h"
#include "core/deform/lattice.h"
#include "core/deform/rasterize.h"
#include "core/volume/label_sampler.h"
#include "core/volume/tiled_labels.h"

namespace limber {

struct InverseMap {
  static constexpr std::uint32_t kNoCell = 0xffffffff;
  static constexpr std::uint16_t kNoBone = 0xffff;
  enum Flag : std::uint8_t { kInverted = 1, kOverlap = 2, kBoneOverlap = 4 };

  VoxelRange range;                 // the tile's voxels in the output lattice
  std::vector<glm::vec3> rest;      // rest point of each voxel
  std::vector<std::uint32_t> cell;  // index of the rest voxel whose cell covers each voxel, or kNoCell
  std::vector<std::uint16_t> bone;  // rig bone whose tissue is painted at each voxel, or kNoBone
  std::vector<std::uint8_t> flags;
  bool has_volume_ratio = true;       // true: posed_per_rest is computed
  std::vector<float> posed_per_rest;  // local ratio of posed to rest volume at each voxel
  std::vector<Label> lost;            // label of each claim that lost to a cell that is no neighbour of its own at rest
  RowSet row_used;                    // 1 for each row of voxels with at least one covered voxel

  // Clears the map and sets its range of voxels.
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

// A subset of the tissue, as one bit mask per brick, in the layout of TissueVoxels::Brick::mask.
using TissueMask = std::vector<std::array<std::uint64_t, 8>>;

// Writes the output voxels that the posed cells of `bricks` (ascending) cover into the map.
//   priority  by label: where cells overlap, the one whose tissue has the higher priority wins
//   depth     depth of rest points below air, which decides between cells in a fold; nullptr: the pose makes no fold
//   without   cells to leave out, since their tissue moves with a tet mesh; nullptr: none
void rasterize_cells(InverseMap& map, const PosedLattice& lattice, const std::vector<std::int64_t>& bricks,
                     const std::vector<int>& priority, const TissueDepth* depth, const TissueMask* without = nullptr);

// The bone tissue of a volume, which is posed rigidly.
class RigidBones {
 public:
  // The tissue of one rig bone in one brick.
  struct Piece {
    int bone;
    std::int64_t brick;
    VoxelRange rest;           // bounding box of the piece's voxels, plus one voxel for interpolation
    VoxelRange posed;          // voxels of the output lattice that the posed box `rest` can reach
    VoxelRange posed_centres;  // voxels whose centres lie in the posed bounding box of the bone voxels themselves
  };

  // Every voxel of bone tissue moves rigidly with the bone of its first influence. Other influences are ignored.
  //   is_bone  1 for each label that is bone tissue; may be all zero
  RigidBones(const PosedLattice& lattice, const SkinWeights& weights, const LabelSet& is_bone,
             const std::vector<RigidTransform>& posed_from_rest);

  const std::vector<Piece>& pieces() const { return pieces_; }
  // Returns the rest point that the motion of a bone moves to a posed voxel.
  glm::dvec3 rest_point(int bone, const glm::dvec3& posed) const;
  // Returns the distance in mm between a posed voxel and the position to which the bone's motion moves a rest point.
  double residual(int bone, const glm::dvec3& rest, const glm::dvec3& posed) const;
  // Returns the rig bone of a voxel of bone tissue; -1: not bone tissue.
  int owner(const glm::ivec3& voxel) const;
  // Returns 1 + the rig bone for every voxel of bone tissue at rest, 0 elsewhere.
  TiledLabels numbered() const;
  RowSet rest_rows() const;  // rows of the rest volume that may contain bone tissue
  // Returns true if there is tissue of this rig bone at a rest point.
  bool has(int bone, const glm::dvec3& rest, const LabelSampler& sampler, bool nearest) const;

  // Paints the bone tissue of `pieces` into the map.
  void paint(InverseMap& map, const std::vector<std::int64_t>& pieces, const LabelSampler& sampler, bool nearest,
             const TissueDepth* depth) const;

 private:
  void find_pieces();
  std::pair<glm::dvec3, glm::dvec3> posed_box(int bone, const VoxelRange& voxels) const;

  const PosedLattice* lattice_;
  const SkinWeights* weights_;
  const LabelSet* is_bone_;
  // For each bone, the affine map posed point -> (rest - posed), in rest voxels.
  std::vector<AffineTransform> rest_shift_;
  // For each bone, the affine map rest point -> (posed - rest), in rest voxels.
  std::vector<AffineTransform> posed_shift_;
  std::vector<Piece> pieces_;
};

}  // namespace limber
