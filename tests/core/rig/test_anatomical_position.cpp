// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "core/phantom/phantom.h"
#include "core/rig/anatomical_position.h"
#include "core/rig/joint_angle.h"
#include "core/rig/joint_ranges.h"

using namespace limber;

namespace {

int joint(const std::string& name) {
  const auto all = usual_joints();
  return static_cast<int>(std::find(all.begin(), all.end(), name) - all.begin());
}

// Makes an arm in any orientation whose elbow rests bent by `degrees`.
Armature bent_arm(double degrees, const glm::dquat& turned) {
  const glm::dvec3 elbow = turned * glm::dvec3(0, 0, -300);
  const glm::dvec3 wrist =
      elbow + turned * (glm::angleAxis(glm::radians(degrees), glm::dvec3(-1, 0, 0)) * glm::dvec3(0, 0, -250));
  Armature rig;
  rig.bones.push_back({"UpperArm", -1, {0, 0, 0}, elbow, 0, {}});
  rig.bones.push_back({"Forearm", 0, elbow, wrist, 0, {}});
  return rig;
}

double between(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

glm::dvec3 along(const Bone& bone) { return glm::normalize(bone.tail - bone.head); }

}  // namespace

TEST_CASE("anatomical zero: an elbow that rests bent straightens to 0 and bends to 150, however the arm lies") {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (const double rest : {0.0, 20.0, 61.5, 120.0})
    for (int i = 0; i < 10; ++i) {
      // A straight elbow shows its bending direction only if the arm hangs.
      const glm::dquat turned =
          rest == 0 ? glm::dquat(1, 0, 0, 0)
                    : glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
      Armature rig = bent_arm(rest, turned);
      INFO("rests at ", rest);
      rig.bones[1].limits = usual_limits(rig, 1, joint("Elbow"));
      const JointLimits& limits = rig.bones[1].limits;
      CHECK(glm::degrees(limits.minimum) == doctest::Approx(-rest));
      CHECK(glm::degrees(limits.maximum) == doctest::Approx(150 - rest));
      const auto bent_to = [&](double angle) {
        return between(along(rig.bones[0]), glm::angleAxis(angle, limits.axis) * along(rig.bones[1]));
      };
      CHECK(bent_to(limits.minimum) == doctest::Approx(0).epsilon(1e-5));
      CHECK(bent_to(limits.maximum) == doctest::Approx(150));
      const auto reading = read_joint(rig.bones[1], glm::angleAxis(glm::radians(-0.5 * rest), limits.axis), limits.axis,
                                      turn_at_rest(rig, 1));
      REQUIRE(reading);
      CHECK(glm::degrees(reading->angle) == doctest::Approx(0.5 * rest));
      CHECK(range_text(*reading) == "0\u00b0 to 150\u00b0");
      CHECK(limits_text(rig, 1) == "hinge, 0 to 150 degrees");
    }
}

TEST_CASE("anatomical zero: a hinge whose axis runs the other way round is turned about, so that it bends on") {
  Armature rig = bent_arm(60, {1, 0, 0, 0});
  const JointLimits usual = usual_limits(rig, 1, joint("Elbow"));
  rig.bones[1].limits = usual;
  rig.bones[1].limits.axis = -usual.axis;
  CHECK(usual_limits(rig, 1, joint("Elbow")).axis == usual.axis);
  // If the rest pose lies beyond the range, the range is extended to it.
  rig = bent_arm(160, {1, 0, 0, 0});
  CHECK(usual_limits(rig, 1, joint("Elbow")).maximum == 0);
}

TEST_CASE("anatomical zero: hinges of the procedural rigs reach from straight to the end of their range") {
  for (const Armature& rig : {make_arm_phantom(10).armature, make_body_phantom(10).armature}) {
    const auto joints = usual_joints_of(rig);
    int hinges = 0;
    for (int b = 0; b < std::ssize(rig.bones); ++b) {
      if (!joints[b]) continue;
      Armature with = rig;
      with.bones[b].limits = usual_limits(rig, b, *joints[b]);
      const JointLimits& limits = with.bones[b].limits;
      CHECK(limit_excess(with.bones[b], {1, 0, 0, 0}) == 0);
      if (limits.type != JointLimits::Type::Hinge || usual_joints()[*joints[b]] == "Toes") continue;
      INFO(rig.bones[b].name);
      ++hinges;
      // Projected along the axis and turned back by its rest angle, the bone continues the direction of its parent.
      const auto across = [&](const glm::dvec3& v) { return v - glm::dot(v, limits.axis) * limits.axis; };
      const double at_rest = hinge_angle_at_rest(with, b, limits.axis);
      const glm::dvec3 straight = across(glm::angleAxis(-at_rest, limits.axis) * along(rig.bones[b]));
      CHECK(between(straight, across(along(rig.bones[rig.bones[b].parent]))) < 1e-4);
    }
    CHECK(hinges >= 4);
  }
}

TEST_CASE(
    "anatomical zero: arms hang, thighs go on from the trunk, feet stand at right angles, hands lie along the "
    "forearm") {
  Armature rig;
  rig.bones.push_back({"Hips", -1, {0, 0, 0}, {0, 0, 100}, 0, {}});
  rig.bones.push_back({"Spine", 0, {0, 0, 100}, {0, 0, 400}, 0, {}});
  rig.bones.push_back({"Neck", 1, {0, 0, 400}, {0, -30, 480}, 0, {}});
  rig.bones.push_back({"LeftArm", 1, {150, 0, 380}, {450, 0, 380}, 0, {}});  // the arm of a T-pose
  rig.bones.push_back({"LeftForeArm", 3, {450, 0, 380}, {700, 0, 380}, 0, {}});
  rig.bones.push_back({"LeftHand", 4, {700, 0, 380}, {790, 0, 330}, 0, {}});
  rig.bones.push_back({"LeftUpLeg", 0, {90, 0, 0}, {90, -400, 0}, 0, {}});  // the thigh of a sitting body
  rig.bones.push_back({"LeftLeg", 6, {90, -400, 0}, {90, -400, -400}, 0, {}});
  // This foot slopes down to the toes by 18 degrees.
  rig.bones.push_back({"LeftFoot", 7, {90, -400, -400}, {90, -520, -440}, 0, {}});
  const auto swing = [&](const std::string& name, BodyPart part) {
    return glm::degrees(ball_swing_at_rest(rig, *rig.find(name), part));
  };
  CHECK(glm::length(swing("LeftArm", BodyPart::UpperArm)) == doctest::Approx(90));
  CHECK(glm::length(swing("LeftUpLeg", BodyPart::Thigh)) == doctest::Approx(90));
  CHECK(glm::length(swing("LeftHand", BodyPart::Hand)) == doctest::Approx(glm::degrees(std::atan2(50.0, 90.0))));
  CHECK(swing("LeftFoot", BodyPart::Foot) == glm::dvec3(0));
  CHECK(swing("Neck", BodyPart::Neck) == glm::dvec3(0));
  // Of the 180 degrees by which an arm can be raised, 90 are left upwards, and 90 lead down to hanging.
  CHECK(glm::degrees(usual_limits(rig, 3, joint("Shoulder")).cone) == doctest::Approx(90));
  // Of the hip's 120 degrees, 30 are left, but the 90 that straighten the thigh need a cone of 90.
  CHECK(glm::degrees(usual_limits(rig, 6, joint("Hip")).cone) == doctest::Approx(90));
  CHECK(glm::degrees(usual_limits(rig, 7, joint("Knee")).minimum) == doctest::Approx(-90));
  rig.bones[8].tail = {90, -480, -540};  // the foot stands on tiptoe
  CHECK(glm::length(swing("LeftFoot", BodyPart::Foot)) == doctest::Approx(glm::degrees(std::atan2(140.0, 80.0))));
  // Without a trunk, the direction of a hanging arm is unknown.
  CHECK(ball_swing_at_rest(bent_arm(60, {1, 0, 0, 0}), 0, BodyPart::UpperArm) == glm::dvec3(0));
}

TEST_CASE("joint readings: what breaks a limit is said once, the angle and what is turned across the hinge apart") {
  Bone hinge{"B", -1, {0, 0, 0}, {0, 0, 10}, 0, {}};
  hinge.limits.type = JointLimits::Type::Hinge;
  hinge.limits.axis = {1, 0, 0};
  hinge.limits.maximum = glm::radians(150.0);
  const glm::dvec3 x(1, 0, 0);
  const auto turned = [&](double degrees) { return glm::angleAxis(glm::radians(degrees), x); };
  CHECK(excess_text(hinge, turned(60), glm::dvec3(0)) == "");
  CHECK(excess_text(hinge, turned(-83.1), glm::dvec3(0)) == "beyond 0\u00b0 by 83.1\u00b0");
  CHECK(text_of(*read_joint(hinge, turned(-83.1), x)) == "Flexion -83.1\u00b0, beyond 0\u00b0 by 83.1\u00b0");
  CHECK(text_of(*read_joint(hinge, turned(54), x)) == "Flexion 54.0\u00b0 of 150\u00b0");
  const glm::dquat sideways = exponential({0, glm::radians(34.5), 0});
  CHECK(excess_text(hinge, sideways, glm::dvec3(0)) == "34.5\u00b0 across the hinge");
  CHECK(excess_text(hinge, sideways * turned(-83.1), glm::dvec3(0)) ==
        "beyond 0\u00b0 by 83.1\u00b0, 34.5\u00b0 across");
}
