// SPDX-License-Identifier: AGPL-3.0-or-later
// The four largest weights of every tissue voxel while bones are solved for one after the other.
#pragma once

#include <cstdint>
#include <vector>

#include "core/rig/armature.h"
#include "core/skin/skin_weights.h"

namespace limber {

class BestFour {
 public:
  // Kept as a reference. Memory is as much as the bricks' most mixed voxels need: 4 bytes for each bone of theirs.
  explicit BestFour(const TissueVoxels& tissue) : tissue_(tissue), bricks_(tissue.bricks().size()) {
    for (std::size_t b = 0; b < bricks_.size(); ++b) bricks_[b].count = tissue.bricks()[b].count();
  }

  // `brick` holds `place`; threads may work on different bricks.
  // The weight of a bone at a place, 0 .. 1. Each bone is offered once.
  void offer(std::int64_t brick, std::int64_t place, int bone, float weight);
  // The voxel is rigid with `bone`.
  void hold(std::int64_t brick, std::int64_t place, int bone);
  // The same wherever `bones`, #tissue voxels, is not `none`.
  void hold_all(const std::vector<std::uint16_t>& bones, std::uint16_t none);
  bool covered(std::int64_t brick, std::int64_t place) const { return at(brick, place, 0).weight > 0; }

  // Normalized; every voxel must be covered. Called once: what is handed over is forgotten.
  SkinWeights weights(std::vector<std::string> bone_names);

 private:
  struct Slot {
    std::uint16_t bone = 0, weight = 0;
  };
  struct Brick {
    int used = 0;             // bones that a voxel has at most
    int count = 0;            // voxels
    std::vector<Slot> slots;  // used x #voxels, by falling weight, not normalized
  };
  Slot at(std::int64_t brick, std::int64_t place, int k) const {
    const Brick& here = bricks_[brick];
    return k < here.used ? here.slots[k * here.count + place - tissue_.bricks()[brick].first] : Slot();
  }
  Slot& grow_to(std::int64_t brick, std::int64_t place, int k);

  const TissueVoxels& tissue_;
  std::vector<Brick> bricks_;
};

// By index.
std::vector<std::string> names_of_bones(const Armature& armature);

}  // namespace limber
