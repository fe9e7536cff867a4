// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/rigid.h"

#include "core/skin/best_four.h"
#include "core/skin/soft_body.h"

namespace limber {

SkinWeights bind_rigid(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature, const BoneParts& parts,
                       Progress& progress, WeightsReport* report) {
  progress.update("weights", 0);
  const std::vector<std::uint16_t> held_by = bone_holding(volume, tissue, parts, armature);
  const NearestBone nearest = nearest_bone(volume, tissue, armature, held_by);
  progress.update("weights", 0.8);
  BestFour best(tissue.size());
  for (std::int64_t place = 0; place < tissue.size(); ++place)
    if (nearest.bone[place] != kSoft) best.hold(place, nearest.bone[place]);
  WeightsReport ignored;
  cover_islands(volume, tissue, armature, best, report ? *report : ignored);
  return best.weights(names_of_bones(armature), tissue);
}

}  // namespace limber
