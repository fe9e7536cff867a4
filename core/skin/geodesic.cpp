// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/geodesic.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/skin/best_four.h"
#include "core/skin/soft_body.h"
#include "core/skin/tissue_front.h"

namespace limber {

namespace {
// A bone this many times further than the nearest has less than a fiftieth of its weight.
constexpr float kFurthest = 7;
constexpr float kUnit = 100;  // mm
}  // namespace

SkinWeights bind_geodesic(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                          const BoneParts& parts, const GeodesicBinding& settings, Progress& progress, WeightsReport* report) {
  progress.update("weights", 0);
  const std::vector<std::uint16_t> held_by = bone_holding(volume, tissue, parts, armature);
  const NearestBone nearest = nearest_bone(volume, tissue, armature, held_by);
  const int bone_count = static_cast<int>(armature.bones.size());
  std::vector<std::vector<std::pair<std::int64_t, glm::i16vec3>>> sources(bone_count);
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (held_by[place] != kSoft) sources[held_by[place]].push_back({place, glm::i16vec3(v)});
  });

  std::vector<float> stiffness;  // #tissue voxels; empty: 1
  if (!settings.stiffness.empty()) {
    stiffness.assign(tissue.size(), 1);
    tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
      if (const auto found = settings.stiffness.find(volume.at(v)); found != settings.stiffness.end()) stiffness[place] = static_cast<float>(found->second);
    });
  }

  BestFour best(tissue.size());
  TissueFront front(volume, tissue);
  std::vector<float> distance(tissue.size(), std::numeric_limits<float>::infinity());
  const auto falloff = static_cast<float>(settings.falloff);
  auto strength = [&](float d) {
    const float bound = (1 - falloff) * d / kUnit + falloff * d * d / (kUnit * kUnit);
    return 1 / (bound * bound);
  };
  for (int bone = 0; bone < bone_count; ++bone) {
    std::vector<std::int64_t> reached;
    for (const auto& [place, voxel] : sources[bone]) {
      distance[place] = 0;
      front.start(place, glm::ivec3(voxel));
    }
    front.spread(
        [&](std::int64_t, std::int64_t to, float way) {
          return held_by[to] == kSoft && way < distance[to] && way <= kFurthest * nearest.distance[to];
        },
        [&](std::int64_t, std::int64_t to, float way) {
          if (distance[to] == std::numeric_limits<float>::infinity()) reached.push_back(to);
          distance[to] = way;
        });
    // Over the nearest bone's, so that a weight is at most one before the sum is.
    std::vector<float> weight(reached.size());
    for (size_t i = 0; i < reached.size(); ++i) {
      weight[i] = std::min(1.0f, strength(distance[reached[i]]) / strength(nearest.distance[reached[i]]));
      if (!stiffness.empty()) weight[i] = std::pow(weight[i], stiffness[reached[i]]);
    }
    best.offer(reached, weight, 1, 0, bone);
    for (std::int64_t place : reached) distance[place] = std::numeric_limits<float>::infinity();
    for (const auto& [place, voxel] : sources[bone]) distance[place] = std::numeric_limits<float>::infinity();
    progress.update("weights", double(bone + 1) / bone_count);
  }
  for (std::int64_t place = 0; place < tissue.size(); ++place)
    if (held_by[place] != kSoft) best.hold(place, held_by[place]);
  WeightsReport ignored;
  cover_islands(volume, tissue, armature, best, report ? *report : ignored);
  return best.weights(names_of_bones(armature), tissue);
}

}  // namespace limber
