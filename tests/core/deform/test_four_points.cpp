// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/deform/blend_rule.h"
#include "core/deform/corner_poser.h"
#include "core/platform/host.h"

using namespace limber;

namespace {

std::vector<RigidTransform> random_motions(std::mt19937& random, int count) {
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<RigidTransform> motions(1);  // the first bone does not move
  while (std::ssize(motions) < count)
    motions.push_back({glm::normalize(glm::dquat(any(random), any(random), any(random), any(random))),
                       40.0 * glm::dvec3(any(random), any(random), any(random))});
  return motions;
}

// Random weights for four corners. Some of the bones influence only some of the corners.
std::vector<FourWeights> random_weights(std::mt19937& random, int bones) {
  std::uniform_int_distribution<int> any(-30000, 65535);
  std::vector<FourWeights> weights;
  for (int bone = 0; bone < bones; ++bone) {
    FourWeights four{bone, {}};
    for (int i = 0; i < 4; ++i) four.weight[i] = bone == i % bones ? 1000.0 : std::max(0, any(random));
    weights.push_back(four);
  }
  return weights;
}

std::vector<BoneWeight> weights_of_one(const std::vector<FourWeights>& four, int lane) {
  std::vector<BoneWeight> one;
  for (const auto& [bone, weight] : four)
    if (weight[lane] > 0) one.push_back({bone, weight[lane]});
  return one;
}

}  // namespace

TEST_CASE("four points: every blend poses four points as it poses each of them, bit for bit") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-300, 300);
  for (int repeat = 0; repeat < 200; ++repeat) {
    const std::vector<SkinTransform> bones = skin_transforms(random_motions(random, 6));
    const std::vector<FourWeights> weights = random_weights(random, 6);
    FourPoints rest;
    for (int i = 0; i < 4; ++i) rest.x[i] = place(random), rest.y[i] = place(random), rest.z[i] = place(random);
    for (const BlendRule* rule : blend_rules())
      for (const bool wide : {false, true}) {
        if (wide && !has_avx2()) continue;
        CAPTURE(rule->word);
        CAPTURE(wide);
        FourPoints posed = rest;
        (wide ? rule->four_points_wide : rule->four_points)(bones, weights, posed);
        for (int i = 0; i < 4; ++i) {
          const glm::dvec3 alone = rule->point(bones, weights_of_one(weights, i), {rest.x[i], rest.y[i], rest.z[i]});
          CHECK(glm::dvec3(posed.x[i], posed.y[i], posed.z[i]) == alone);
        }
      }
  }
}

TEST_CASE("four points: four corners are posed as each of them, also where one follows a single bone") {
  std::mt19937 random(11);
  const Grid grid{{60, 50, 40}, {0.7, 1.3, 2}, {-5, 9, 2}, glm::dmat3(0, 1, 0, -1, 0, 0, 0, 0, 1)};
  const std::vector<std::string> names{"a", "b", "c", "d"};
  std::uniform_int_distribution<int> along(0, 40);
  for (int repeat = 0; repeat < 100; ++repeat) {
    const std::vector<RigidTransform> motions = random_motions(random, 4);
    for (const Blend blend : {Blend::Linear, Blend::DualQuaternion, Blend::Mixed}) {
      CornerPoser poser(grid, names, motions, blend);
      poser.set_output({glm::dvec3(0.9, 1, 1.7), {3, -2, 11}});
      std::vector<FourWeights> weights = random_weights(random, 4);
      for (FourWeights& four : weights)
        four.weight[repeat % 3] = four.bone == repeat % 4 ? 700 : 0;  // this corner follows one bone
      CornerWeights::Four given{weights, {}};
      FourPoints rest, shift;
      glm::ivec3 corner[4];
      for (int i = 0; i < 4; ++i) {
        corner[i] = {along(random), along(random), along(random)};
        rest.x[i] = corner[i].x - 0.5, rest.y[i] = corner[i].y - 0.5, rest.z[i] = corner[i].z - 0.5;
        shift.x[i] = 0.25 * along(random), shift.y[i] = -0.125 * along(random), shift.z[i] = 0.3f * along(random);
        given.bones[i] = static_cast<int>(weights_of_one(weights, i).size());
      }
      for (const bool shifted : {false, true}) {
        const auto [x, y, z] = poser.posed(rest, given, shifted ? &shift : nullptr);
        for (int i = 0; i < 4; ++i) {
          const glm::dvec3 by = shifted ? glm::dvec3(shift.x[i], shift.y[i], shift.z[i]) : glm::dvec3(0);
          CHECK(FixedPoint(x[i], y[i], z[i]) == poser.posed(corner[i], weights_of_one(weights, i), by));
        }
      }
    }
  }
}

TEST_CASE("four points: a corner that is carried too far is refused like any other") {
  const Grid grid{{8, 8, 8}, glm::dvec3(1), glm::dvec3(0), glm::dmat3(1)};
  const std::vector<std::string> names{"Hips", "Knee"};
  CornerPoser poser(grid, names, {{}, {glm::dquat(1, 0, 0, 0), {0, 0, 90000}}}, Blend::Linear);
  const std::vector<FourWeights> weights{{0, FourNumbers{1, 1, 0, 1}}, {1, FourNumbers{0, 0, 9, 0}}};
  std::string said;
  try {
    poser.posed(FourPoints{}, {weights, FourIntegers{1, 1, 1, 1}}, nullptr);
  } catch (const Error& error) {
    said = error.what();
  }
  CHECK(said.find("bone Knee") != std::string::npos);
}
