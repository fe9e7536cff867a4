// SPDX-License-Identifier: AGPL-3.0-or-later
// Collects the four largest weights of every tissue voxel, while the weights of one bone after the other are computed.
#pragma once

#include <cstdint>
#include <vector>

#include "core/rig/armature.h"
#include "core/skin/skin_weights.h"

namespace limber {

class BestFour {
 public:
  // Keeps a reference to `tissue`. Memory: 4 bytes per voxel and slot. All voxels of a brick have as many slots as the
  // voxel with the most bones needs, at most four.
  explicit BestFour(const TissueVoxels& tissue) : tissue_(tissue), bricks_(tissue.bricks().size()) {
    for (std::size_t b = 0; b < bricks_.size(); ++b) bricks_[b].count = tissue.bricks()[b].count();
  }

  // In these functions, `place` is a voxel's index in the list of tissue voxels, and `brick` is the brick that contains
  // it. Threads may work on different bricks at the same time.
  //
  // offer() adds the weight [0, 1] of a bone at a voxel. It may be called once for each bone and voxel.
  void offer(std::int64_t brick, std::int64_t place, int bone, float weight);
  // Makes the voxel follow `bone` with full weight, and no other bone.
  void hold(std::int64_t brick, std::int64_t place, int bone);
  // Makes many voxels follow one bone each. `bones` (#tissue voxels) has the bone of each voxel, or `none` for a voxel
  // that stays as it is.
  void hold_all(const std::vector<std::uint16_t>& bones, std::uint16_t none);
  bool covered(std::int64_t brick, std::int64_t place) const { return at(brick, place, 0).weight > 0; }

  // Returns the normalized weights; every voxel must have a weight. May be called only once, since it frees the
  // collected weights.
  SkinWeights weights(std::vector<std::string> bone_names);

 private:
  struct Slot {
    std::uint16_t bone = 0, weight = 0;
  };
  struct Brick {
    int used = 0;   // number of slots: the largest number of bones of a voxel in this brick
    int count = 0;  // number of tissue voxels
    // Slot 0 of all voxels, then slot 1 ...; weights descend from slot to slot and are not normalized.
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
