// SPDX-License-Identifier: AGPL-3.0-or-later
// Collects the four largest weights of every tissue voxel while a solver computes the weights of one bone after
// another.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/rig/armature.h"
#include "core/skin/skin_weights.h"

namespace limber {

class BestFour {
 public:
  // Keeps a reference to `tissue`. Memory: 4 bytes per voxel and slot, where a slot holds one bone and its weight. Each
  // brick has as many slots per voxel as its voxel with the most bones needs, at most four.
  explicit BestFour(const TissueVoxels& tissue) : tissue_(tissue), bricks_(tissue.bricks().size()) {
    for (std::size_t b = 0; b < bricks_.size(); ++b) bricks_[b].count = tissue.bricks()[b].count();
  }

  // In these functions, `place` is a voxel's index in the list of tissue voxels, and `brick` is the index of the brick
  // that contains the voxel. Threads may work on different bricks at the same time.
  //
  // offer() adds the weight [0, 1] of a bone at a voxel. Call it at most once for each bone and voxel.
  void offer(std::int64_t brick, std::int64_t place, int bone, float weight);
  // Makes the voxel follow `bone` with full weight, and no other bone.
  void hold(std::int64_t brick, std::int64_t place, int bone);
  // Makes many voxels follow one bone each. `bones` (#tissue voxels) lists the bone of each voxel; a voxel with the
  // entry `none` does not change.
  void hold_all(std::span<const std::uint16_t> bones, std::uint16_t none);
  // Returns the weight [0, 1] that a bone was offered with, without normalization; 0 if it is not among the largest
  // four.
  float weight(std::int64_t brick, std::int64_t place, int bone) const;
  bool covered(std::int64_t brick, std::int64_t place) const { return at(brick, place, 0).weight > 0; }

  // Returns the normalized weights. Every voxel must have a weight. Call this only once, since it frees the collected
  // weights.
  SkinWeights weights(std::vector<std::string> bone_names);

 private:
  struct Slot {
    std::uint16_t bone = 0, weight = 0;
  };
  struct Brick {
    int used = 0;   // slots per voxel: the largest number of bones of any voxel in this brick
    int count = 0;  // number of tissue voxels
    // First slot 0 of all voxels, then slot 1 of all voxels, and so on. From slot to slot a voxel's weights descend;
    // their sum is not normalized.
    std::vector<Slot> slots;
  };
  Slot at(std::int64_t brick, std::int64_t place, int k) const {
    const Brick& here = bricks_[brick];
    return k < here.used ? here.slots[k * here.count + place - tissue_.bricks()[brick].first] : Slot();
  }
  Slot& grow_to(std::int64_t brick, std::int64_t place, int k);

  const TissueVoxels& tissue_;
  std::vector<Brick> bricks_;
};

// Returns the names of the armature's bones, in their order.
std::vector<std::string> names_of_bones(const Armature& armature);

}  // namespace limber
