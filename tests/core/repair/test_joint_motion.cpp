// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/repair/joint_motion.h"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/phantom/phantom.h"

using namespace limber;

namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

Armature bent_rig() {
  Armature rig;
  rig.bones = {{"upper", -1, {0, 0, 100}, {0, 0, 0}},
               {"lower", 0, {0, 0, 0}, {0, -80, -60}},
               {"end", 1, {0, -80, -60}, {0, -90, -70}},
               {"other", 0, {0, 0, 0}, {0, 80, -60}}};
  return rig;
}

}  // namespace

TEST_CASE("joint motion: the turns cover the range in equal steps of at most 22.5 degrees and move the bones below") {
  const JointMotion motion = joint_motion(bent_rig(), 1, TurnRange{-30, 90});
  std::vector<double> degrees;
  for (const JointTurn& turn : motion.turns) degrees.push_back(std::round(turn.angle / kDegree * 10) / 10);
  CHECK(degrees == std::vector<double>{-15, -30, 22.5, 45, 67.5, 90});
  CHECK(motion.moving == std::vector<int>{1, 2});
  CHECK(motion.centre == glm::dvec3(0, 0, 0));
  Pose flexed = rest_pose(bent_rig());
  flex(flexed, bent_rig(), 1, 90);
  const Pose pose = turned(bent_rig(), motion, motion.turns.back());
  CHECK(std::abs(glm::dot(pose.rotation[1], flexed.rotation[1])) == doctest::Approx(1));
}

TEST_CASE("joint motion: a hinge moves over its own range, a bone without limits or a known name from 0 to 90") {
  Armature rig = bent_rig();
  CHECK(joint_motion(rig, 1, {}).turns.back().angle == doctest::Approx(90 * kDegree));
  rig.bones[1].limits = {.type = JointLimits::Type::Hinge, .axis = {1, 0, 0}, .minimum = -0.1, .maximum = 0.7};
  const JointMotion hinge = joint_motion(rig, 1, {});
  CHECK(hinge.turns.front().angle == doctest::Approx(-0.1));
  CHECK(hinge.turns.back().angle == doctest::Approx(0.7));
  CHECK(hinge.turns.back().axis == glm::dvec3(1, 0, 0));
}

TEST_CASE("joint motion: hips and shoulders that names tell flex, extend and abduct") {
  const Armature rig = make_body_phantom(10).armature;
  for (const char* name : {"LeftUpperArm", "RightThigh"}) {
    const auto bone = rig.find(name);
    REQUIRE(bone);
    const JointMotion motion = joint_motion(rig, *bone, {});
    CHECK(motion.turns.size() >= 5);
    // The turns have different axes, and none is the rest pose.
    CHECK(std::any_of(motion.turns.begin(), motion.turns.end(), [&](const JointTurn& turn) {
      return std::abs(glm::dot(turn.axis, motion.turns[0].axis)) < 0.5;
    }));
    for (const JointTurn& turn : motion.turns) CHECK(turn.angle >= 5 * kDegree);
  }
}

TEST_CASE("joint motion: a root, and a range without a turn, are refused with what to do") {
  CHECK_THROWS_WITH_AS(joint_motion(bent_rig(), 0, {}), doctest::Contains("choose a bone that has a parent"), Error);
  for (const TurnRange& range : {TurnRange{0, 0}, TurnRange{10, 90}, TurnRange{-2, 3}, TurnRange{0, 171},
                                 TurnRange{-90, -10}, TurnRange{0, NAN}})
    CHECK_THROWS_WITH_AS(joint_motion(bent_rig(), 1, range), doctest::Contains("such as 0,90"), Error);
}

TEST_CASE("joint motion: a joint that its limits hold still, and a ball without a length, are refused") {
  Armature rig = bent_rig();
  rig.bones[1].limits = {.type = JointLimits::Type::Fixed};
  CHECK_THROWS_WITH_AS(joint_motion(rig, 1, {}), doctest::Contains("do not let this joint turn"), Error);
  CHECK(joint_motion(rig, 1, TurnRange{0, 45}).turns.size() == 2);
  rig.bones[1].limits = {.type = JointLimits::Type::Hinge, .axis = {1, 0, 0}, .minimum = 0, .maximum = 4 * kDegree};
  CHECK_THROWS_WITH_AS(joint_motion(rig, 1, {}), doctest::Contains("do not let this joint turn"), Error);
  rig.bones[1].limits = {.type = JointLimits::Type::Ball, .cone = 1};
  rig.bones[1].tail = rig.bones[1].head;
  CHECK_THROWS_WITH_AS(joint_motion(rig, 1, {}), doctest::Contains("has no length"), Error);
}
