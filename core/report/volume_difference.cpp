// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/volume_difference.h"

#include <cmath>

#include "core/base/parallel.h"

namespace limber {

DifferingSide differing(const LabelVolume& volume, const TissueVoxels& tissue, const LabelVolume& from) {
  constexpr std::int64_t kGrain = 64;  // number of bricks (cubes of 8^3 voxels) per task of parallel_for
  const AffineTransform to_world = world_from_voxel(volume.grid), to_voxel = voxel_from_world(from.grid);
  DifferingSide side;
  side.voxels.resize(static_cast<std::size_t>(tissue.size()));
  parallel_for(std::ssize(tissue.bricks()), kGrain, [&](std::int64_t begin, std::int64_t end) {
    tissue.for_each(begin, end, [&](std::int64_t place, const glm::ivec3& voxel) {
      const glm::dvec3 there = to_voxel * (to_world * glm::dvec3(voxel));
      const Label label = from.at_or_air(glm::ivec3(glm::floor(there + 0.5)));
      side.voxels[static_cast<std::size_t>(place)] = label == volume.at(voxel) ? Differs::Not
                                                     : label == 0              ? Differs::Air
                                                                               : Differs::Tissue;
    });
  });
  tissue.for_each([&](std::int64_t place, const glm::ivec3& voxel) {
    const Differs differs = side.voxels[static_cast<std::size_t>(place)];
    if (differs == Differs::Not) return;
    auto& count = side.counts[volume.at(voxel)];
    ++(differs == Differs::Air ? count.air : count.other_tissue);
  });
  for (const auto& [label, count] : side.counts) {
    side.total.air += count.air;
    side.total.other_tissue += count.other_tissue;
  }
  return side;
}

}  // namespace limber
