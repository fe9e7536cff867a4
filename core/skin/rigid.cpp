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
  BestFour best(tissue);
  best.hold_all(nearest.bone, kSoft);
  WeightsReport ignored;
  cover_islands(volume, tissue, armature, best, report ? *report : ignored);
  return best.weights(names_of_bones(armature));
}

}  // namespace limber
