// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/joint_limits.h"

#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

using namespace limber;

namespace {

glm::dquat any_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
}

Bone bone_with(const JointLimits& limits) {
  return {.name = "b", .head = {0, 0, 0}, .tail = {0, 0, 10}, .limits = limits};
}

double angle_between(const glm::dquat& a, const glm::dquat& b) {
  return 2 * std::acos(std::min(1.0, std::abs(glm::dot(a, b))));
}

}  // namespace

TEST_CASE("joint limits: swing and twist make up the rotation again, the swing at right angles to the axis") {
  std::mt19937 random(1);
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1, -2, 0.5));
  for (int i = 0; i < 1000; ++i) {
    const glm::dquat rotation = any_rotation(random);
    const SwingTwist parts = swing_twist(rotation, axis);
    CHECK(std::abs(glm::dot(parts.swing, axis)) < 1e-12);
    CHECK(glm::length(parts.swing) <= std::numbers::pi + 1e-12);
    CHECK(angle_between(rotation_of(parts, axis), rotation) < 1e-7);
  }
  const SwingTwist rest = swing_twist({1, 0, 0, 0}, axis);
  CHECK(rest.swing == glm::dvec3(0));
  CHECK(rest.twist == 0);
}

TEST_CASE("joint limits: what comes out is within them, and what was within them comes out as it was") {
  std::mt19937 random(2);
  const JointLimits hinge{.type = JointLimits::Type::Hinge, .axis = {1, 0, 0}, .minimum = -0.2, .maximum = 2.4};
  const JointLimits ball{.type = JointLimits::Type::Ball, .cone = 1.1, .twist_minimum = -0.7, .twist_maximum = 0.4};
  const JointLimits fixed{.type = JointLimits::Type::Fixed};
  for (const JointLimits& limits : {hinge, ball, fixed, JointLimits{}})
    for (int i = 0; i < 500; ++i) {
      const Bone bone = bone_with(limits);
      const glm::dquat allowed = within_limits(bone, any_rotation(random));
      CHECK(limit_excess(bone, allowed) < 1e-7);
      CHECK(within_limits(bone, allowed) == allowed);
    }
}

TEST_CASE("joint limits: a hinge bent too far stops at its end, and a swing too wide at its cone") {
  const Bone elbow = bone_with({.type = JointLimits::Type::Hinge, .axis = {1, 0, 0}, .minimum = 0, .maximum = 2.5});
  CHECK(angle_between(within_limits(elbow, exponential({3.0, 0, 0})), exponential({2.5, 0, 0})) < 1e-9);
  CHECK(angle_between(within_limits(elbow, exponential({-0.4, 0, 0})), {1, 0, 0, 0}) < 1e-9);
  CHECK(limit_excess(elbow, exponential({-0.4, 0, 0})) == doctest::Approx(0.4));

  const Bone hip = bone_with({.type = JointLimits::Type::Ball, .cone = 1, .twist_minimum = -0.5, .twist_maximum = 0.5});
  CHECK(angle_between(within_limits(hip, exponential({0, 1.7, 0})), exponential({0, 1, 0})) < 1e-9);
  CHECK(angle_between(within_limits(hip, exponential({0, 0, 0.9})), exponential({0, 0, 0.5})) < 1e-9);
  CHECK(limit_excess(bone_with({}), exponential({3, 0, 0})) == 0);
}
