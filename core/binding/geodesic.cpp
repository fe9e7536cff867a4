// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/geodesic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/parallel.h"
#include "core/binding/cover_islands.h"
#include "core/binding/flesh_graph.h"
#include "core/binding/geodesic_front.h"

namespace limber {

namespace {
// A bone is ignored if its distance from a voxel is more than this multiple of the nearest bone's distance. Its weight
// would be less than 1/49 of the nearest bone's weight (at stiffness 1).
constexpr float kFurthest = 7;
constexpr float kUnit = 100;  // unit of distances in the weight formula, mm
}  // namespace

SkinWeights bind_geodesic(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                          const BoneParts& parts, const GeodesicBinding& settings, Progress& progress,
                          WeightsReport* report, const TissueTable* tissues) {
  progress.update("weights", 0);
  const ZeroedVector<std::uint16_t> held_by = fixed_bone(volume, tissue, parts, armature);
  const NearestBone nearest = nearest_bone(volume, tissue, armature, held_by);
  const int bone_count = static_cast<int>(armature.bones.size());
  std::vector<std::vector<std::pair<std::int64_t, glm::i16vec3>>> sources(bone_count);
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (held_by[place] != kSoft) sources[held_by[place]].push_back({place, glm::i16vec3(v)});
  });

  std::vector<float> stiffness;  // stiffness of each tissue voxel; empty: all are 1
  if (!settings.stiffness.empty()) {
    stiffness.assign(tissue.size(), 1);
    tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
      if (const auto found = settings.stiffness.find(volume.at(v)); found != settings.stiffness.end())
        stiffness[place] = static_cast<float>(found->second);
    });
  }

  BestFour best(tissue);
  TissueFront front(volume, tissue);
  std::vector<float> distance(tissue.size(), std::numeric_limits<float>::infinity());
  const auto falloff = static_cast<float>(settings.falloff);
  auto strength = [&](float d) {
    const float bound = (1 - falloff) * d / kUnit + falloff * d * d / (kUnit * kUnit);
    return 1 / (bound * bound);
  };
  for (int bone = 0; bone < bone_count; ++bone) {
    for (const auto& [place, voxel] : sources[bone]) {
      distance[place] = 0;
      front.start(place, glm::ivec3(voxel), static_cast<std::uint16_t>(bone));
    }
    front.spread(
        distance,
        [&](std::uint16_t, std::int64_t to, float way) {
          return held_by[to] == kSoft && way < distance[to] && way <= kFurthest * nearest.distance[to];
        },
        [&](std::uint16_t, std::int64_t to, float way) { distance[to] = way; });
    parallel_for(std::ssize(tissue.bricks()), 256, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t brick = begin; brick < end; ++brick) {
        const std::int64_t first = tissue.bricks()[brick].first;
        for (std::int64_t place = first; place < first + tissue.bricks()[brick].count(); ++place) {
          const float way = std::exchange(distance[place], std::numeric_limits<float>::infinity());
          if (held_by[place] != kSoft || way == std::numeric_limits<float>::infinity()) continue;
          // Divides the weight by the nearest bone's weight, so that it is at most 1 before normalization.
          float weight = std::min(1.0f, strength(way) / strength(nearest.distance[place]));
          if (!stiffness.empty()) weight = std::pow(weight, stiffness[place]);
          best.offer(brick, place, bone, weight);
        }
      }
    });
    progress.update("weights", double(bone + 1) / bone_count);
  }
  best.hold_all(held_by, kSoft);
  WeightsReport ignored;
  cover_islands(volume, tissue, armature, best, report ? *report : ignored, tissues);
  return best.weights(names_of_bones(armature));
}

}  // namespace limber
