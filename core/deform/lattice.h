// SPDX-License-Identifier: AGPL-3.0-or-later
// Poses a volume's tissue as a lattice of cells. Every tissue voxel is a cell, and its eight corners are vertices. A
// vertex follows the mean of the influences of the tissue voxels around it (up to eight). So cells that share a vertex
// at rest share it in the pose, and there are no gaps between the posed cells.
//
// Coordinates. A *rest point* is in voxel coordinates of the volume (voxel centres are whole numbers). A *posed point*
// is in voxels of the output lattice, relative to an integer base near the tissue, in fixed point: integers in units of
// 1/65536 voxel. So the rasterizer's decisions are exact, and so is the rest pose, whose corners are multiples of 1/2.
// The output lattice is the volume's own lattice, or one with another spacing that has the same outermost corner.
//
// Corners are computed brick by brick, and stored as long as the output needs them (kept_corners.h). All bricks that
// share a corner compute the same position for it, bit for bit: weights are added as integers, in ascending order of
// the bones.
//
// Much of a posed limb follows one bone with full weight, or bones with the same motion: a hand whose fingers do not
// bend moves with the forearm. The first bone with a motion stands for all bones that have this motion. Corners that
// follow one bone take its motion in voxel coordinates without blending. If the bone does not move, its corners stay at
// their rest positions, bit for bit.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/deform/corner_poser.h"
#include "core/deform/kept_corners.h"
#include "core/deform/output_lattice.h"
#include "core/deform/skinning.h"
#include "core/skin/skin_weights.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

class FleshShifts;

// The box of voxels from `low` to `high`, both included; empty if high < low on any axis.
struct VoxelRange {
  glm::ivec3 low{0}, high{-1};

  bool empty() const { return high.x < low.x || high.y < low.y || high.z < low.z; }
  bool contains(const glm::ivec3& v) const {
    return v.x >= low.x && v.y >= low.y && v.z >= low.z && v.x <= high.x && v.y <= high.y && v.z <= high.z;
  }
};
inline VoxelRange intersect(const VoxelRange& a, const VoxelRange& b) {
  return {glm::max(a.low, b.low), glm::min(a.high, b.high)};
}

class PosedLattice {
 public:
  static constexpr int kSide = KeptCorners::kSide;
  // The posed corners of a brick's voxels. Corner (i, j, k), 0 to 8 each, is the lowest corner of voxel brick.corner +
  // (i, j, k). Corners that belong to no tissue voxel of the brick are not set.
  using Corners = KeptCorners::Corners;
  static int place(int i, int j, int k) { return i + kSide * (j + kSide * k); }

  // The posed corners of a brick near a seam, where every voxel has its own corners. The eight corners of voxel (i, j,
  // k) of the brick begin at index 8 * (i + 8 * (j + 8 * k)); bits 0, 1, 2 of a corner's index are x, y, z. Corners of
  // air voxels are not set.
  using SplitBrick = std::array<FixedPoint, 8 * TissueVoxels::kBrick * TissueVoxels::kBrick * TissueVoxels::kBrick>;

  // Keeps references to `volume`, `tissue`, `weights` and `shifts`, which must outlive the lattice.
  //   posed_from_rest  motions of the bones of `weights`
  //   shifts           corrections of flesh that are added to the blended positions; nullptr: none
  //   throws Error if the pose moves tissue further than 32 000 output voxels or to a position that is not finite
  PosedLattice(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
               const std::vector<RigidTransform>& posed_from_rest, Blend blend, const glm::dvec3& ratio,
               Progress& progress = no_progress(), const FleshShifts* shifts = nullptr);

  const OutputLattice& output() const { return output_; }
  const LabelVolume& volume() const { return *volume_; }
  const TissueVoxels& tissue() const { return *tissue_; }
  // Returns the bounding box of the brick's posed corners.
  const FixedBox& bounds(std::int64_t brick) const { return bounds_[brick]; }
  // Returns true if the pose moves no cell of the brick. Always false if output voxels and the volume's voxels differ
  // in size.
  bool is_still(std::int64_t brick) const { return still_[brick]; }
  // Returns the bone that the brick and all tissue around it follow with full weight, so that its cells move as one
  // rigid body; -1: several bones.
  int only_bone(std::int64_t brick) const { return rigid_[brick]; }
  // Returns the affine map from posed points to rest points, for tissue that follows the bone with full weight.
  const AffineTransform& rest_from_posed(int bone) const { return rest_from_posed_[bone]; }
  // Writes the brick's posed corners into `room` and returns them.
  const Corners& corners(std::int64_t brick, Corners& room) const;
  // Frees the memory of the corners of bricks that are entirely below `z` in the output. Later requests compute these
  // corners again. No other function of the lattice may run at the same time.
  void forget_corners_below(int z) const { kept_.forget_below(z); }
  // Returns true if the pose bends the brick and a seam is near, so that each of its voxels has its own corners.
  bool is_split(std::int64_t brick) const { return split_[brick]; }
  void split_corners(std::int64_t brick, SplitBrick& corners) const;

 private:
  struct BrickBounds {
    FixedBox box;
    bool still;
  };
  BrickBounds compute(std::int64_t brick, Corners& corners) const;
  FixedBox split_bounds(std::int64_t brick) const;
  class CollectedCorners;
  void pose_bent(std::int64_t brick, CollectedCorners& corners) const;
  AffineTransform backward(const RigidTransform& posed_from_rest) const;
  glm::ivec3 base(const RigidTransform& posed_from_rest) const;

  const LabelVolume* volume_;
  const TissueVoxels* tissue_;
  const SkinWeights* weights_;
  AffineTransform world_from_voxel_, voxel_from_world_;
  CornerPoser poser_;
  const FleshShifts* shifts_;
  OutputLattice output_;
  std::vector<FixedBox> bounds_;
  std::vector<std::uint8_t> still_, split_;       // values of is_still() and is_split() for each brick
  std::vector<AffineTransform> rest_from_posed_;  // values of rest_from_posed() for each bone
  std::vector<int> moves_as_;                     // for each bone, the first bone with the same motion
  std::vector<int> rigid_;                        // values of only_bone() for each brick
  mutable KeptCorners kept_;                      // stored corners of bent bricks; all others are computed on request
};

}  // namespace limber
