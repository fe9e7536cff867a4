// SPDX-License-Identifier: AGPL-3.0-or-later
// A volume's tissue as a lattice of cells, posed. Every tissue voxel is a cell, its eight corners are vertices; a
// vertex follows the mean of the influences of the tissue voxels around it (up to eight), so that cells that share a
// vertex at rest share it posed, and the posed cells leave no gap.
//
// Coordinates. A *rest point* is in voxel coordinates of the volume (voxel centres are whole numbers). A *posed point*
// is in voxels of the output lattice, relative to a whole-number base near the tissue, stored in fixed point: whole
// numbers of 1/65536 voxel. So the rasterizer's decisions are exact, and the rest pose, whose corners are halves of
// whole numbers, is exact too. The output lattice is the volume's own, or one with another spacing that shares its
// outermost corner.
//
// Corners are computed brick by brick, and kept only while all of them are small: a whole body's would be 150 MB. The
// same corner comes out the same, bit for bit, from every brick that has it: weights are added as whole numbers, bones
// in rising order.
//
// Much of a posed limb follows one bone wholly, or bones that move as one: a hand whose fingers keep still goes where
// the forearm goes. Bones that move as one are counted as one, the first of them. Corners that follow one alone take
// its motion in voxel coordinates without blending, and where it does not move at all they stay what they are: whole
// halves, bit for bit.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/deform/skinning.h"
#include "core/skin/skin_weights.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

class SettledFlesh;

constexpr int kFixedOne = 65536;  // one output voxel
using FixedPoint = glm::ivec3;    // in 1/65536 output voxel

// Whole voxels low .. high, both in; empty when high < low on an axis.
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

// Between rest lattice and output lattice: output = (rest + 0.5) * ratio - 0.5 - base.
struct OutputLattice {
  glm::dvec3 ratio{1};  // input spacing / output spacing, 1 exactly where they are equal
  glm::ivec3 base{0};

  glm::dvec3 from_rest(const glm::dvec3& rest) const { return (rest + 0.5) * ratio - 0.5 - glm::dvec3(base); }
  glm::dvec3 to_rest(const glm::dvec3& output) const { return (output + glm::dvec3(base) + 0.5) / ratio - 0.5; }
};

class PosedLattice {
 public:
  static constexpr int kSide = TissueVoxels::kBrick + 1;
  // Corner (i, j, k), 0 .. 8 each, is the lowest corner of voxel brick.corner + (i, j, k). Unset where no tissue is
  // near.
  using Corners = std::array<FixedPoint, kSide * kSide * kSide>;
  static int place(int i, int j, int k) { return i + kSide * (j + kSide * k); }

  // Where a seam is near, every voxel has corners of its own: those of voxel (i, j, k) of the brick, in the order of
  // bits x, y, z, begin at 8 * (i + 8 * (j + 8 * k)). Unset where no tissue is.
  using SplitBrick = std::array<FixedPoint, 8 * TissueVoxels::kBrick * TissueVoxels::kBrick * TissueVoxels::kBrick>;

  struct FixedBox {
    FixedPoint low, high;
  };

  // Keeps references: volume, tissue, weights and settled must outlive the lattice.
  //   posed_from_rest  #bones of `weights`
  //   settled          how flesh moves beyond blending; nullptr: not at all
  // throws Error when tissue is carried further than 32 000 output voxels or to a place that is not finite
  PosedLattice(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
               const std::vector<RigidTransform>& posed_from_rest, Blend blend, const glm::dvec3& ratio,
               Progress& progress = no_progress(), const SettledFlesh* settled = nullptr);

  const OutputLattice& output() const { return output_; }
  const LabelVolume& volume() const { return *volume_; }
  const TissueVoxels& tissue() const { return *tissue_; }
  const FixedBox& bounds(std::int64_t brick) const { return bounds_[brick]; }  // of the brick's posed corners
  // Whether every cell of the brick lies where it lay at rest, and output voxels are the volume's own.
  bool is_still(std::int64_t brick) const { return still_[brick]; }
  // The bone that the brick and all tissue around it follow wholly, so that its cells move as one; -1 where they are
  // several.
  int only_bone(std::int64_t brick) const { return rigid_[brick]; }
  // Rest points by posed points of what follows that bone wholly.
  const AffineTransform& rest_from_posed(int bone) const { return rest_from_posed_[bone]; }
  // The brick's corners; computed into `room` where they are not kept.
  const Corners& corners(std::int64_t brick, Corners& room) const;
  // Whether a seam is near and the brick bends, so that its voxels' own corners count.
  bool is_split(std::int64_t brick) const { return split_[brick]; }
  void split_corners(std::int64_t brick, SplitBrick& corners) const;

 private:
  FixedPoint posed(const glm::ivec3& corner, std::span<const BoneWeight> influences, const glm::dvec3& shift) const;
  FixedPoint fixed(const glm::dvec3& rest, const glm::dvec3& moved, int bone) const;
  [[noreturn]] void throw_torn(int bone) const;
  FixedPoint posed_by(int bone, const glm::ivec3& corner) const;
  struct BrickBounds {
    FixedBox box;
    bool still;
  };
  BrickBounds compute(std::int64_t brick, Corners& corners) const;
  FixedBox split_bounds(std::int64_t brick) const;
  template <class Visit, class Posed>
  BrickBounds compute_by(std::int64_t brick, const Visit& visit, const Posed& posed, Corners& corners) const;
  AffineTransform backward(const RigidTransform& posed_from_rest) const;
  void choose_base();

  const LabelVolume* volume_;
  const TissueVoxels* tissue_;
  const SkinWeights* weights_;
  AffineTransform world_from_voxel_, voxel_from_world_;
  std::vector<SkinTransform> bones_;
  std::vector<AffineTransform> shift_;  // per bone: posed - rest, both in voxel coordinates, of the rest point
  Blend blend_;
  const SettledFlesh* settled_;
  OutputLattice output_;
  std::vector<FixedBox> bounds_;
  std::vector<std::uint8_t> still_, split_;       // by brick
  std::vector<AffineTransform> rest_from_posed_;  // per bone
  std::vector<int> moves_as_;                     // per bone: the first that moves as it does
  std::vector<int> rigid_;           // by brick: the bone that all tissue of it and around it moves as, or several
  std::unique_ptr<Corners[]> kept_;  // of the bricks that bend, or none
  std::vector<std::int32_t> kept_at_;
};

}  // namespace limber
