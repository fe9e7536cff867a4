// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/rigid.h"

#include "core/binding/cover_islands.h"
#include "core/binding/flesh_graph.h"

namespace limber {

SkinWeights bind_rigid(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                       const BoneParts& parts, Progress& progress, WeightsReport* report, const TissueTable* tissues) {
  progress.update("weights", 0);
  const ZeroedVector<std::uint16_t> held_by = fixed_bone(volume, tissue, parts, armature);
  const NearestBone nearest = nearest_bone(volume, tissue, armature, held_by);
  progress.update("weights", 0.8);
  BestFour best(tissue);
  best.hold_all({nearest.bone.data(), nearest.bone.size()}, kSoft);
  WeightsReport ignored;
  cover_islands(volume, tissue, armature, best, report ? *report : ignored, tissues);
  return best.weights(names_of_bones(armature));
}

}  // namespace limber
