// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/cli/posed_box.h"

#include "core/base/parallel.h"

namespace limber::editor {

std::array<glm::dvec3, 2> box_of_posed(const Grid& rest_grid, const Grid& grid, const TissueVoxels& tissue,
                                       const SkinWeights& weights, const std::vector<RigidTransform>& posed_from_rest,
                                       Blend blend) {
  const std::vector<SkinTransform> bones = skin_transforms(posed_from_rest);
  const AffineTransform to_world = world_from_voxel(rest_grid), to_voxel = voxel_from_world(grid);
  std::vector<std::array<glm::dvec3, 2>> boxes(tissue.bricks().size(), {glm::dvec3(1e300), glm::dvec3(-1e300)});
  parallel_for(std::ssize(boxes), 16, [&](std::int64_t begin, std::int64_t end) {
    for (auto brick = begin; brick < end; ++brick) {
      auto influence = weights.chunk(brick).begin();
      tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& voxel) {
        std::array<limber::BoneWeight, 4> influences;
        int count = 0;
        const Influence follows = *influence++;
        for (; count < 4 && follows.weight[count]; ++count)
          influences[count] = {follows.bone[count], double(follows.weight[count])};
        const glm::dvec3 posed =
            to_voxel * blend_point(blend, bones, {influences.data(), size_t(count)}, to_world * glm::dvec3(voxel));
        boxes[brick] = {glm::min(boxes[brick][0], posed - 0.5), glm::max(boxes[brick][1], posed + 0.5)};
      });
    }
  });
  std::array<glm::dvec3, 2> all = boxes.at(0);
  for (const auto& [low, high] : boxes) all = {glm::min(all[0], low), glm::max(all[1], high)};
  return all;
}

}  // namespace limber::editor
