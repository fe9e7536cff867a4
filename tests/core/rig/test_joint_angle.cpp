// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>

#include <doctest/doctest.h>

#include "core/rig/joint_angle.h"

using namespace limber;

namespace {

Bone bone_with(JointLimits::Type type) {
  Bone bone{"B", -1, {0, 0, 0}, {0, 0, 10}, 0, {}};
  bone.limits.type = type;
  bone.limits.axis = {1, 0, 0};
  bone.limits.minimum = -0.1;
  bone.limits.maximum = 2.5;
  return bone;
}

}  // namespace

TEST_CASE("joint readings: a hinge tells its flexion, whichever way round it is turned, and nothing across it") {
  const Bone hinge = bone_with(JointLimits::Type::Hinge);
  const glm::dquat bent = glm::angleAxis(0.7, glm::dvec3(1, 0, 0));
  for (const double sense : {1.0, -1.0}) {
    const auto reading = read_joint(hinge, bent, {sense, 0, 0});
    REQUIRE(reading);
    CHECK(reading->kind == JointReading::Kind::Flexion);
    CHECK(reading->angle == doctest::Approx(0.7));
    CHECK(reading->maximum == 2.5);
    CHECK(reading->sense == sense);
  }
  CHECK(!read_joint(hinge, bent, {0, 1, 0}));
  CHECK(!read_joint(bone_with(JointLimits::Type::Free), bent, {1, 0, 0}));
  CHECK(read_joint(bone_with(JointLimits::Type::Fixed), bent, {1, 0, 0})->kind == JointReading::Kind::Fixed);
}

TEST_CASE("joint readings: at the end of a ball's swing the limits begin to bite") {
  Bone ball = bone_with(JointLimits::Type::Ball);
  ball.limits.axis = {0, 0, 1};
  ball.limits.cone = 0.8;
  ball.limits.twist_minimum = -0.3;
  ball.limits.twist_maximum = 0.4;
  const glm::dquat sideways = exponential({0, 0.5, 0});
  const auto swing = read_joint(ball, sideways, {1, 0, 0});
  REQUIRE(swing);
  CHECK(swing->kind == JointReading::Kind::Swing);
  CHECK(swing->angle == doctest::Approx(0));
  CHECK(limit_excess(ball, exponential({swing->maximum - 1e-6, 0.5, 0})) == 0);
  CHECK(limit_excess(ball, exponential({swing->maximum + 1e-3, 0.5, 0})) > 0);
  const auto twist = read_joint(ball, glm::angleAxis(0.2, glm::dvec3(0, 0, 1)), {0, 0, 1});
  REQUIRE(twist);
  CHECK(twist->kind == JointReading::Kind::Twist);
  CHECK(twist->angle == doctest::Approx(0.2));
  CHECK(twist->maximum == 0.4);
}
