// SPDX-License-Identifier: AGPL-3.0-or-later
// The small limb with weights: voxels below its joint have weight 1 for the second bone, all others for the first.
#pragma once

#include "tests/editor/small_limb.h"

namespace limber::test {

inline std::shared_ptr<const SkinWeights> half_weights(const LabelVolume& volume) {
  const TissueVoxels tissue(volume);
  SkinWeights weights({"Upper", "Fore"}, tissue);
  const AffineTransform world = world_from_voxel(volume.grid);
  for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
    SkinWeights::Influences chunk = weights.chunk(brick);
    tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& voxel) {
      chunk[place - tissue.bricks()[brick].first] = rigid_influence((world * glm::dvec3(voxel)).z < 0);
    });
    weights.set_chunk(brick, chunk);
  }
  return std::make_shared<const SkinWeights>(weights);
}

}  // namespace limber::test
