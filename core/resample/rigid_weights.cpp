// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/rigid_weights.h"

#include <algorithm>

#include "core/bones/bone_parts.h"

namespace limber {

SkinWeights with_rigid_bones(const SkinWeights& weights, const LabelVolume& volume, const TissueVoxels& tissue,
                             const TissueTable& tissues, const LabelSet& is_bone, const Armature& armature,
                             Progress& progress) {
  auto is_rigid = [&](std::int64_t brick) {
    const auto& chunk = weights.chunk(brick);
    const std::int64_t first = tissue.bricks()[brick].first;
    bool rigid = true;
    tissue.for_each_of(brick, volume, is_bone, [&](std::int64_t place, const glm::ivec3&) {
      rigid &= chunk[place - first].weight[0] == kFullWeight;
    });
    return rigid;
  };
  std::int64_t soft = 0;
  while (soft < weights.chunk_count() && is_rigid(soft)) ++soft;
  if (soft == weights.chunk_count()) return weights;

  const BoneParts parts = split_bones(volume, tissue, tissues, armature, progress);
  std::vector<int> bone_of_part;
  for (const auto& part : parts.parts) {
    const auto found = std::find(weights.bones().begin(), weights.bones().end(), armature.bones[part.bone].name);
    bone_of_part.push_back(found == weights.bones().end() ? -1 : int(found - weights.bones().begin()));
  }
  SkinWeights rigid = weights;
  for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
    bool has_bone = false;
    tissue.for_each_of(brick, volume, is_bone, [&](std::int64_t, const glm::ivec3&) { has_bone = true; });
    if (!has_bone) continue;
    SkinWeights::Influences chunk = weights.chunk(brick);
    auto influence = chunk.begin();
    tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& v) {
      Influence& mine = *influence++;
      if (!is_bone[volume.at(v)]) return;
      const int part = parts.part_of[place], bone = part ? bone_of_part[part - 1] : -1;
      mine = rigid_influence(bone >= 0 ? bone : mine.bone[0]);
    });
    rigid.set_chunk(brick, std::move(chunk));
  }
  return rigid;
}

}  // namespace limber
