// SPDX-License-Identifier: AGPL-3.0-or-later
// Skins one million points with 1.78 influences each. Blender 3.4's armature modifier, on points only, does 13.5
// (linear) and 10.2 (dual quaternion) million points a second on one core.
#include <glm/gtc/quaternion.hpp>

#include "core/deform/skinning.h"
#include "tests/bench/bench.h"

namespace limber::bench {

namespace {

struct Crowd {
  std::vector<SkinTransform> bones;
  std::vector<BoneWeight> influences;
  std::vector<std::int64_t> offsets;
  std::vector<glm::dvec3> rest, posed;
};

// Makes points along a chain of 20 bones. Of 100 points, 22 follow one bone, the others two.
Crowd make_crowd(std::int64_t count) {
  Crowd crowd;
  std::vector<RigidTransform> posed;
  for (int i = 0; i < 20; ++i)
    posed.push_back(
        rotation_about({0, 0, 20.0 * i}, glm::angleAxis(0.1 * i, glm::normalize(glm::dvec3(1, 0.3, 0.1 * i)))));
  crowd.bones = skin_transforms(posed);
  for (std::int64_t i = 0; i < count; ++i) {
    const double along = 18.99 * static_cast<double>(i) / static_cast<double>(count);
    const int bone = static_cast<int>(along);
    crowd.offsets.push_back(std::ssize(crowd.influences));
    crowd.rest.push_back({10.0 * (i % 7), 10.0 * (i % 5), 20 * along});
    if (i % 100 < 22) {
      crowd.influences.push_back({bone, 1});
    } else {
      crowd.influences.push_back({bone, 1 - (along - bone)});
      crowd.influences.push_back({bone + 1, along - bone});
    }
  }
  crowd.offsets.push_back(std::ssize(crowd.influences));
  crowd.posed.resize(crowd.rest.size());
  return crowd;
}

void skin_points(benchmark::State& state, Blend blend, double peer_rate) {
  constexpr std::int64_t kPoints = 1'000'000;
  Crowd crowd = make_crowd(kPoints);
  for (auto _ : state) {
    blend_points(blend, crowd.bones, crowd.influences, crowd.offsets, crowd.rest, crowd.posed);
    benchmark::DoNotOptimize(crowd.posed.data());
  }
  against_peer_rate(state, kPoints, peer_rate, 3);
}

}  // namespace

BENCHMARK_CAPTURE(skin_points, linear, Blend::Linear, 13.5e6)->Apply(five_times);
BENCHMARK_CAPTURE(skin_points, dual_quaternion, Blend::DualQuaternion, 10.2e6)->Apply(five_times);

}  // namespace limber::bench
