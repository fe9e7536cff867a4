// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/simd_weights.h"

#include <algorithm>
#include <random>
#include <stdexcept>

#include <doctest/doctest.h>

#include "core/skin/normalize.h"
#include "tests/core/skin/small_body.h"

using namespace limber;

namespace {

constexpr int kBones = 6;

Armature chain() {
  Armature armature;
  for (int b = 0; b < kBones; ++b)
    armature.bones.push_back(
        test::bone_between(("Bone" + std::to_string(b)).c_str(), b - 1, glm::dvec3(b, 0, 0), glm::dvec3(b + 1, 0, 0)));
  return armature;
}

// Returns one to four bones in random order. Their weights are equal, nearly equal, negligible beside one, or random.
Influence any_influence(std::mt19937& random) {
  std::vector<int> bones(kBones);
  for (int b = 0; b < kBones; ++b) bones[b] = b;
  std::shuffle(bones.begin(), bones.end(), random);
  const int count = 1 + int(random() % 4), kind = int(random() % 4);
  std::vector<std::pair<int, double>> weights;
  for (int i = 0; i < count; ++i) {
    const double some = kind == 0   ? 1
                        : kind == 1 ? 1 + random() % 3
                        : kind == 2 ? (i ? 1e-5 * (1 + random() % 4) : 1)
                                    : 0.001 + random() % 1000;
    weights.emplace_back(bones[i], some);
  }
  return quantize(weights);
}

}  // namespace

TEST_CASE("weights of many voxels at once: to the bit what comes of one after the other, four and eight at a time") {
  const Armature armature = chain();
  const WeightRules rules(armature, {});
  std::mt19937 random(7);
  for (int round = 0; round < 2000; ++round) {
    std::vector<Influence> influences(64);
    for (Influence& influence : influences) influence = any_influence(random);
    const int bone = int(random() % kBones);
    std::vector<std::uint16_t> asked(influences.size()), found(influences.size());
    for (std::uint16_t& weight : asked) {
      const auto any = random() % 5;  // 0: nearly the full weight; 1: nearly none; else: random
      weight = static_cast<std::uint16_t>(any == 0 ? kFullWeight - random() % 4 : any == 1 ? random() % 4 : random());
    }
    for (const LaneWidth width : {LaneWidth::Widest, LaneWidth::Four}) {
      weights_of(influences, bone, found, width);
      std::vector<Influence> made = influences;
      for (std::size_t i = 0; i < influences.size(); ++i) {
        REQUIRE(found[i] == WeightRules::sum_of(influences[i], std::span(&bone, 1)));
        // Every fourth voxel keeps its weight.
        if (i % 4 == 3) asked[i] = found[i];
      }
      set_weights(made, bone, rules.fallback_bone(bone), asked, width);
      for (std::size_t i = 0; i < influences.size(); ++i) {
        Influence alone = influences[i];
        rules.set(alone, bone, asked[i]);
        REQUIRE(made[i] == alone);
      }
    }
  }
}

TEST_CASE("weights of many voxels at once: only whole groups") {
  std::vector<Influence> influences(kWeightLanes + 1, rigid_influence(0));
  std::vector<std::uint16_t> weights(kWeightLanes + 1);
  CHECK_THROWS_AS(set_weights(influences, 0, 1, weights), std::logic_error);
  CHECK_THROWS_AS(weights_of(influences, 0, std::span(weights).first(kWeightLanes)), std::logic_error);
}
