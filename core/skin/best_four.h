// SPDX-License-Identifier: AGPL-3.0-or-later
// The four largest weights of every tissue voxel while bones are solved for one after the other.
#pragma once

#include <cstdint>
#include <vector>

#include "core/rig/armature.h"
#include "core/skin/heat_diffusion.h"
#include "core/skin/skin_weights.h"

namespace limber {

class BestFour {
 public:
  explicit BestFour(std::int64_t tissue_size) : best_(tissue_size) {}

  // values[i * lanes + lane] is the weight of `bone` at place[i]. Each bone is offered once.
  void offer(const std::vector<std::int64_t>& place, const std::vector<float>& values, int lanes, int lane, int bone);
  // The voxel is rigid with `bone`.
  void hold(std::int64_t place, int bone) { best_[place] = rigid_influence(bone); }
  bool covered(std::int64_t place) const { return best_[place].weight[0] > 0; }

  // Normalized; every voxel must be covered.
  SkinWeights weights(std::vector<std::string> bone_names, const TissueVoxels& tissue) const;

 private:
  std::vector<Influence> best_;  // by falling weight, not normalized
};

std::vector<std::string> names_of_bones(const Armature& armature);

// Tissue that no bone has reached (pieces that lie apart in the air): each piece follows the rig bone nearest to its
// centre, and is named in the report's warnings, the largest first.
void cover_islands(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature, BestFour& best,
                   WeightsReport& report, const TissueTable* tissues = nullptr);

}  // namespace limber
