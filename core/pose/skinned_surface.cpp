// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/skinned_surface.h"

#include "core/skin/skin_at.h"

namespace limber {

SkinnedSurface skinned_surface(const LabelVolume& volume, const SkinWeights& weights, double step) {
  LabelSet all(std::size_t{1} << 16, 1);
  all[0] = 0;
  SkinnedSurface surface{surface_of(occupancy_of(volume, all, step)), {}};
  if (surface.mesh.V.empty()) return surface;
  for (const SkinAt& at : skin_at(volume, TissueVoxels(volume), weights, surface.mesh.V)) surface.influences.push_back(at.influence);
  return surface;
}

std::vector<glm::vec3> posed_points(const SkinnedSurface& surface, const std::vector<RigidTransform>& motions) {
  std::vector<glm::mat3> turn;
  std::vector<glm::vec3> shift;
  for (const RigidTransform& motion : motions) {
    turn.emplace_back(glm::mat3_cast(motion.rotation));
    shift.emplace_back(motion.translation);
  }
  std::vector<glm::vec3> points(surface.mesh.V.size());
  for (std::size_t v = 0; v < points.size(); ++v) {
    const glm::vec3 at(surface.mesh.V[v]);
    const Influence& influence = surface.influences[v];
    glm::vec3 sum(0);
    for (int i = 0; i < 4 && influence.weight[i]; ++i) sum += static_cast<float>(influence.weight[i]) * (turn[influence.bone[i]] * at + shift[influence.bone[i]]);
    points[v] = sum / static_cast<float>(kFullWeight);
  }
  return points;
}

}  // namespace limber
