// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/mirror.h"

#include <cmath>

#include <doctest/doctest.h>

#include "core/rig/joint_limits.h"

using namespace limber;

namespace {

// Makes a trunk with two arms, turned about z by `turn` and moved.
Armature two_arms(double turn) {
  const RigidTransform place{glm::angleAxis(turn, glm::dvec3(0, 0, 1)), {30, -70, 5}};
  Armature armature;
  armature.bones = {{.name = "Trunk", .head = {0, 0, 0}, .tail = {0, 0, 500}},
                    {.name = "LeftArm", .parent = 0, .head = {150, 10, 480}, .tail = {440, 20, 470}, .roll = 0.3},
                    {.name = "LeftForearm", .parent = 1, .head = {440, 20, 470}, .tail = {700, -10, 465}},
                    {.name = "RightArm", .parent = 0, .head = {-150, 10, 480}, .tail = {-440, 20, 470}},
                    {.name = "RightForearm", .parent = 3, .head = {-440, 20, 470}, .tail = {-700, -10, 465}}};
  for (Bone& bone : armature.bones) {
    bone.head = place * bone.head;
    bone.tail = place * bone.tail;
  }
  return armature;
}

}  // namespace

TEST_CASE("mirror: names of the two sides find each other, names without a side find none") {
  for (const auto& [left, right] : {std::pair{"LeftArm", "RightArm"},
                                    {"arm.L", "arm.R"},
                                    {"arm.L.001", "arm.R.001"},
                                    {"thigh_l", "thigh_r"},
                                    {"L_hand", "R_hand"},
                                    {"LThumb", "RThumb"},
                                    {"mixamorig:LeftLeg", "mixamorig:RightLeg"},
                                    {"upper left arm", "upper right arm"},
                                    {"ForeArmLeft", "ForeArmRight"},
                                    {"hand-L", "hand-R"}}) {
    CHECK(mirrored_name(left) == right);
    CHECK(mirrored_name(right) == left);
  }
  for (const char* name : {"Spine", "Lumbar", "Neck1", "Root", "upright", "L", "RIB", "ulnar", ""})
    CHECK(mirrored_name(name) == std::nullopt);
}

TEST_CASE("mirror: the plane lies between the pairs, wherever the rig stands and faces") {
  for (double turn : {0.0, 0.7, 2.9}) {
    const Armature armature = two_arms(turn);
    const MirrorPlane plane = mirror_plane(armature);
    CHECK(glm::distance(plane.place(armature.bones[1].tail), armature.bones[3].tail) < 1e-9);
    CHECK(glm::distance(plane.place(armature.bones[0].tail), armature.bones[0].tail) < 1e-9);
  }
}

TEST_CASE(
    "mirror: a flipped pose carries each side to where the mirror shows the other, and twice flipped is the pose") {
  const Armature armature = two_arms(0.7);
  const MirrorPlane plane = mirror_plane(armature);
  Pose pose = rest_pose(armature);
  pose.rotation[0] = exponential({0.1, -0.2, 0.3});
  pose.rotation[1] = exponential({0.5, 0.9, -0.4});
  pose.rotation[4] = exponential({-1.2, 0.3, 0.8});
  pose.root_translation = {5, 60, -7};
  const Pose other = flipped(pose, armature);
  const auto here = posed_from_rest(armature, pose), there = posed_from_rest(armature, other);
  const auto pairs = mirror_pairs(armature);
  for (int b = 0; b < 5; ++b)
    CHECK(glm::distance(plane.place(here[b] * armature.bones[b].tail),
                        there[pairs[b]] * armature.bones[pairs[b]].tail) < 1e-9);
  const Pose back = flipped(other, armature);
  for (int b = 0; b < 5; ++b) CHECK(std::abs(glm::dot(back.rotation[b], pose.rotation[b])) > 1 - 1e-12);
}

TEST_CASE(
    "mirror: symmetrizing makes the other side the image of this one, adds what is missing and mirrors the limits") {
  Armature armature = two_arms(0.3);
  armature.bones[2].tail += glm::dvec3(10, 30, 5);
  armature.bones[2].limits = {
      .type = JointLimits::Type::Hinge, .axis = glm::normalize(glm::dvec3(0.2, 1, 0.1)), .minimum = -0.1, .maximum = 2};
  armature.bones[1].limits = {
      .type = JointLimits::Type::Ball, .cone = 1.2, .twist_minimum = -0.9, .twist_maximum = 0.2};
  armature.bones.push_back({.name = "LeftHand",
                            .parent = 2,
                            .head = armature.bones[2].tail,
                            .tail = armature.bones[2].tail + glm::dvec3(60, 0, 0)});
  const Armature both = symmetrized(armature, {1, 2, 5});
  const MirrorPlane plane = mirror_plane(armature);
  REQUIRE(both.bones.size() == 7);
  const int hand = require_bone(both, "RightHand");
  CHECK(both.bones[both.bones[hand].parent].name == "RightForearm");
  const auto pairs = mirror_pairs(both);
  for (const char* name : {"LeftArm", "LeftForearm", "LeftHand"}) {
    const Bone &bone = both.bones[require_bone(both, name)], &image = both.bones[pairs[require_bone(both, name)]];
    CHECK(glm::distance(plane.place(bone.head), image.head) < 1e-9);
    CHECK(glm::distance(plane.place(bone.tail), image.tail) < 1e-9);
    CHECK(glm::distance(-plane.direction(rest_axes(bone)[0]), rest_axes(image)[0]) < 1e-9);
  }
  // The mirrored joint has the mirrored limits.
  const Bone &upper = both.bones[require_bone(both, "LeftArm")], &elbow = both.bones[require_bone(both, "LeftForearm")];
  const Bone &other_upper = both.bones[require_bone(both, "RightArm")],
             &other_elbow = both.bones[require_bone(both, "RightForearm")];
  for (double angle : {-0.5, 0.7, 1.9, 2.6}) {
    const glm::dquat bend = exponential(angle * elbow.limits.axis), twist = exponential(angle * twist_axis(upper));
    CHECK(limit_excess(elbow, bend) == doctest::Approx(limit_excess(other_elbow, plane.rotation(bend))).epsilon(1e-6));
    CHECK(limit_excess(upper, twist) ==
          doctest::Approx(limit_excess(other_upper, plane.rotation(twist))).epsilon(1e-6));
  }
}
