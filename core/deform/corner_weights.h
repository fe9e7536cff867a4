// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the influences of the corners of a brick's voxels: for each corner the sum of the influences of the up to
// eight tissue voxels around it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/deform/blend_rule.h"
#include "core/skin/skin_weights.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

class CornerWeights {
 public:
  // Keeps a reference to `moves_as`, which must outlive this object.
  //   moves_as  for each bone, the first bone with the same motion; that bone gets the weight (BrickMotions)
  CornerWeights(const TissueVoxels& tissue, const SkinWeights& weights, const std::vector<int>& moves_as,
                std::int64_t brick);

  // Returns the influences of corner (i, j, k), ascending by bone; empty if there is no tissue around the corner.
  std::span<const BoneWeight> at(const glm::ivec3& corner);

  // The influences of four corners.
  struct Four {
    std::span<const FourWeights> influences;  // weights of all four corners, ascending by bone
    FourIntegers bones;                       // number of bones that each corner follows
  };
  // Returns the influences of four corners at once. Lane n of i, j and k is the position of corner n.
  Four at(const FourIntegers& i, const FourIntegers& j, const FourIntegers& k);

 private:
  static constexpr int kHalo = TissueVoxels::kBrick + 2;  // edge of a brick with a border one voxel wide
  static constexpr int kHaloCount = kHalo * kHalo * kHalo;
  static int place(const glm::ivec3& v) { return v.x + kHalo * (v.y + kHalo * v.z); }
  void gather(const TissueVoxels::Brick& brick, const SkinWeights::Chunk& chunk, const glm::ivec3& step);
  void add(const Influence& influence, int here);
  int slot_of(int bone);
  void sum_over_corners();

  const std::vector<int>& moves_as_;
  // A slot holds the weights of one bone. slot_of_[bone] is the bone's slot, or -1; bones_[slot] is the slot's bone;
  // order_ lists the slots, ascending by bone.
  std::vector<int> slot_of_, bones_, order_;
  std::vector<std::uint32_t> sums_;  // kHaloCount sums of weights for each slot
  // The four bones of the voxel that was added last, packed into one integer, and their slots; -1: not looked up.
  std::uint64_t last_bones_ = 0;
  std::array<int, 4> last_slots_{-1, -1, -1, -1};
  std::vector<BoneWeight> influences_;
  std::vector<FourWeights> four_;
};

}  // namespace limber
