// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests properties that clinical angles must have for every rig: reading is the inverse of setting, a mirrored body
// reads mirrored angles, and position and size of a body do not matter. Directions are compared with definitions that
// are written down by hand.
#include "core/pose/clinical_angles.h"

#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "core/pose/joint_turns.h"
#include "core/rig/mirror.h"
#include "tests/support/body_rig.h"

using namespace limber;
using namespace limber::test;

namespace {

using enum BodyJoint;

// Returns body rigs with different rest poses: hanging, spread and seated, with crooked knees and elbows.
std::vector<Armature> rigs() {
  const std::vector<std::vector<HandTurn>> rests = {
      {},
      {{"LeftUpperArm", {0, 1, 0}, -88}, {"RightUpperArm", {0, 1, 0}, 85}, {"LeftForearm", {0, 0, 1}, -60}},
      {{"LeftThigh", {1, 0, 0}, -80}, {"LeftShank", {1, 0, 0}, 85}, {"RightForearm", {1, 0, 0}, -70}},
      {{"LeftThigh", {0, 1, 0}, -20},
       {"RightThigh", {0, 1, 0}, 12},
       {"RightFoot", {1, 0, 0}, 20},
       {"LeftHandIndex1", {0, 1, 0}, 8},
       {"RightHandThumb1", {1, 0, 0}, 30}}};
  std::vector<Armature> all;
  for (const auto& rest : rests) all.push_back(rested(body_rig(), rest));
  return all;
}

// Returns random angles inside the usual ranges, away from gimbal lock, for every motion that a joint has at rest.
JointAngles random_angles(const Armature& rig, const BodyFrames& frames, std::mt19937& random) {
  JointAngles angles = clinical_angles(rig, frames, rest_pose(rig));
  for (auto& [joint, motions] : angles)
    for (std::size_t i = 0; i < motions.size(); ++i) {
      if (!motions[i]) continue;
      const AngleRange range = *usual_range(joint.joint, i);
      do motions[i] = std::uniform_real_distribution(range.low + 0.5, range.high - 0.5)(random);
      while (at_gimbal_lock(joint.joint, motions));
    }
  return angles;
}

double largest_difference(const JointAngles& a, const JointAngles& b) {
  REQUIRE(a.size() == b.size());
  double largest = 0;
  for (const auto& [joint, motions] : a)
    for (std::size_t i = 0; i < motions.size(); ++i) {
      REQUIRE(motions[i].has_value() == b.at(joint)[i].has_value());
      if (motions[i]) largest = std::max(largest, std::abs(*motions[i] - *b.at(joint)[i]));
    }
  return largest;
}

double largest_turn_between(const Pose& a, const Pose& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.rotation.size(); ++i) {
    const glm::dquat q = glm::conjugate(a.rotation[i]) * b.rotation[i];
    largest = std::max(largest, glm::degrees(2 * std::asin(std::min(1.0, glm::length(glm::dvec3(q.x, q.y, q.z))))));
  }
  return largest;
}

double angle_of(const Armature& rig, const Pose& pose, const SidedJoint& joint, std::size_t motion) {
  return angles_of_joint(rig, body_frames(rig), pose, joint)[motion].value();
}

Pose with(const Armature& rig, const JointAngles& angles) {
  return with_joint_angles(rig, body_frames(rig), rest_pose(rig), angles);
}

}  // namespace

TEST_CASE("clinical angles: a body in the anatomical position reads zero, a body that rests bent reads how far") {
  const Armature straight = body_rig();
  for (const auto& [joint, motions] : clinical_angles(straight, body_frames(straight), rest_pose(straight)))
    for (std::size_t i = 0; i < motions.size(); ++i)
      // This rig's thumbs and toes do not lie in line with the bones before them.
      if (motions[i] && joint.joint != Thumb && !is_finger(joint.joint) && joint.joint != Ankle)
        CHECK_MESSAGE(std::abs(*motions[i]) < 1e-9, name_of(joint), i);
  const Armature bent = rested(straight, {{"LeftUpperArm", {0, 1, 0}, -60},
                                          {"RightForearm", {1, 0, 0}, -70},
                                          {"LeftThigh", {1, 0, 0}, -80},
                                          {"LeftShank", {1, 0, 0}, 95},
                                          {"RightHand", {1, 0, 0}, -20}});
  const Pose rest = rest_pose(bent);
  CHECK(angle_of(bent, rest, {Shoulder, BodySide::Left}, 1) == doctest::Approx(60));
  CHECK(angle_of(bent, rest, {Elbow, BodySide::Right}, 0) == doctest::Approx(70));
  CHECK(angle_of(bent, rest, {Hip, BodySide::Left}, 0) == doctest::Approx(80));
  CHECK(angle_of(bent, rest, {Knee, BodySide::Left}, 0) == doctest::Approx(95));
  CHECK(angle_of(bent, rest, {Wrist, BodySide::Right}, 0) == doctest::Approx(20));
}

TEST_CASE("clinical angles: what was set is read, and what was read sets the same pose, from every rest") {
  std::mt19937 random(7);
  for (const Armature& rig : rigs()) {
    const BodyFrames frames = body_frames(rig);
    for (int i = 0; i < 50; ++i) {
      const JointAngles angles = random_angles(rig, frames, random);
      const Pose pose = with_joint_angles(rig, frames, rest_pose(rig), angles);
      const JointAngles read = clinical_angles(rig, frames, pose);
      CHECK(largest_difference(angles, read) < 1e-6);
      CHECK(largest_turn_between(with_joint_angles(rig, frames, rest_pose(rig), read), pose) < 1e-6);
    }
  }
}

TEST_CASE("clinical angles: any turns of free limbs are read completely, also beyond the usual ranges") {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const Armature rig = rigs()[1];
  const BodyFrames frames = body_frames(rig);
  for (int i = 0; i < 50; ++i) {
    Pose pose = rest_pose(rig);
    for (const char* side : {"Left", "Right"})
      for (const char* bone : {"UpperArm", "Thigh", "Shank", "Foot"})
        pose.rotation[static_cast<std::size_t>(require_bone(rig, std::string(side) + bone))] =
            glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
    JointAngles angles = clinical_angles(rig, frames, pose);
    for (const auto& [joint, motions] : JointAngles(angles))
      if (joint.joint != Shoulder && joint.joint != Hip && joint.joint != Knee && joint.joint != Ankle &&
          joint.joint != Girdle)
        angles.erase(joint);
    CHECK(largest_turn_between(with_joint_angles(rig, frames, rest_pose(rig), angles), pose) < 1e-5);
  }
}

TEST_CASE(
    "clinical angles: a mirrored pose reads the angles of the other side, and bends the trunk to the other side") {
  std::mt19937 random(3);
  const Armature rig = body_rig();
  const BodyFrames frames = body_frames(rig);
  for (int i = 0; i < 20; ++i) {
    const JointAngles angles = random_angles(rig, frames, random);
    const JointAngles read =
        clinical_angles(rig, frames, flipped(with_joint_angles(rig, frames, rest_pose(rig), angles), rig));
    JointAngles mirrored;
    for (const auto& [read_joint, read_motions] : angles) {
      SidedJoint joint = read_joint;
      JointMotions motions = read_motions;
      if (!is_paired(joint.joint)) motions[1] = -*motions[1], motions[2] = -*motions[2];
      else joint.side = joint.side == BodySide::Left ? BodySide::Right : BodySide::Left;
      mirrored[joint] = motions;
    }
    CHECK(largest_difference(mirrored, read) < 1e-6);
  }
}

namespace {

// Returns the angles of a pose after the rig and the pose were turned, moved and scaled, and the bones' rolls changed.
JointAngles read_moved(const Armature& rig, const Pose& pose, const glm::dquat& turn) {
  Armature other = moved(rig, turn, {300, -40, 7});
  Pose turned = pose;
  for (std::size_t b = 0; b < other.bones.size(); ++b) {
    other.bones[b].head *= 0.4;
    other.bones[b].tail *= 0.4;
    other.bones[b].roll += 0.3 * static_cast<double>(b);
    turned.rotation[b] = turn * pose.rotation[b] * glm::conjugate(turn);
  }
  return clinical_angles(other, body_frames(other), turned);
}

}  // namespace

TEST_CASE("clinical angles: neither place, direction, size nor the rolls of bones change what a pose reads") {
  std::mt19937 random(5);
  const glm::dquat quarter = glm::angleAxis(glm::radians(90.0), glm::dvec3(1, 0, 0)),
                   askew = glm::angleAxis(0.6, glm::normalize(glm::dvec3(1, 2, 3))),
                   more = glm::angleAxis(1.4, glm::normalize(glm::dvec3(1, -2, 0.3)));
  for (const Armature& rig : rigs()) {
    const BodyFrames frames = body_frames(rig);
    const Pose pose = with_joint_angles(rig, frames, rest_pose(rig), random_angles(rig, frames, random));
    const JointAngles read = clinical_angles(rig, frames, pose);
    CHECK(largest_difference(read, read_moved(rig, pose, {1, 0, 0, 0})) < 1e-6);
    CHECK(largest_difference(read, read_moved(rig, pose, quarter)) < 1e-6);
    // A body that is upright within 7.5 degrees is measured in the world's axes, a tilted one in its own. So only two
    // tilted bodies read equal angles.
    CHECK(largest_difference(read_moved(rig, pose, askew), read_moved(rig, pose, more * askew)) < 1e-6);
  }
}

TEST_CASE("clinical angles: one angle changes alone, and a shoulder leads its collarbone by the rhythm") {
  std::mt19937 random(13);
  const Armature rig = rigs()[3];
  const BodyFrames frames = body_frames(rig);
  const JointAngles before = random_angles(rig, frames, random);
  const Pose pose = with_joint_angles(rig, frames, rest_pose(rig), before);
  for (const auto& [joint, motions] : before)
    for (std::size_t i = 0; i < motions.size(); ++i) {
      if (!motions[i]) continue;
      const AngleRange range = *usual_range(joint.joint, i);
      const double asked = range.low + 0.3 * (range.high - range.low);
      JointAngles expected = before;
      expected[joint][i] = asked;
      if (joint.joint == Shoulder)
        *expected[{Girdle, joint.side}][2] +=
            (std::max(0.0, raise_of_arm(expected[joint]) - 30) - std::max(0.0, raise_of_arm(motions) - 30)) / 6;
      // Shoulder angles are relative to the trunk. A motion of the girdle moves the arm, so the shoulder's angles may
      // change.
      const Pose changed = with_clinical_angle(rig, frames, pose, joint, i, asked);
      JointAngles read = clinical_angles(rig, frames, changed);
      if (joint.joint == Girdle) read[{Shoulder, joint.side}] = expected[{Shoulder, joint.side}];
      CHECK_MESSAGE(largest_difference(expected, read) < 1e-6, name_of(joint), i);
    }
}

TEST_CASE("clinical angles: an arm raised beyond level reads as it was raised, and a level arm reads no flexion") {
  const Armature rig = body_rig();
  const SidedJoint shoulder{Shoulder, BodySide::Left};
  const auto read = [&](const JointMotions& motions) {
    return angles_of_joint(rig, body_frames(rig), with(rig, {{shoulder, motions}}), shoulder);
  };
  const auto near = [](const JointMotions& motions, double flexion, double abduction, double rotation) {
    CHECK(std::abs(*motions[0] - flexion) < 1e-6);
    CHECK(std::abs(*motions[1] - abduction) < 1e-6);
    CHECK(std::abs(*motions[2] - rotation) < 1e-6);
  };
  near(read({0.0, 160.0, 0.0}), 0, 160, 0);
  near(read({160.0, 0.0, 20.0}), 160, 0, 20);
  near(read({180.0, 0.0, 0.0}), 180, 0, 0);
  near(read({0.0, 180.0, 0.0}), 0, 180, 0);
  near(read({-50.0, 10.0, -80.0}), -50, 10, -80);
  near(read({90.0, -30.0, -95.0}), 90, -30, -95);
  CHECK(at_gimbal_lock(Shoulder, read({30.0, 90.0, 20.0})));
  CHECK_FALSE(at_gimbal_lock(Shoulder, read({30.0, 89.0, 20.0})));
  const JointMotions locked = read({30.0, 90.0, 20.0});
  CHECK(std::abs(*locked[0]) < 1e-6);
  CHECK(largest_turn_between(with(rig, {{shoulder, locked}}), with(rig, {{shoulder, {30.0, 90.0, 20.0}}})) < 1e-5);
}

TEST_CASE("clinical angles: a joint that is a hinge has one angle about its own axis, within the rig's range") {
  Armature rig = rested(body_rig(), {{"LeftShank", {1, 0, 0}, 20}});
  const auto shank = static_cast<std::size_t>(require_bone(rig, "LeftShank"));
  rig.bones[shank].limits = {
      .type = JointLimits::Type::Hinge, .axis = glm::normalize(glm::dvec3(1, 0.1, 0)), .minimum = -0.4, .maximum = 2.0};
  const BodyFrames frames = body_frames(rig);
  const SidedJoint knee{Knee, BodySide::Left};
  Pose pose = rest_pose(rig);
  pose.rotation[shank] = glm::angleAxis(0.7, rig.bones[shank].limits.axis);
  const JointMotions read = angles_of_joint(rig, frames, pose, knee),
                     at_rest = angles_of_joint(rig, frames, rest_pose(rig), knee);
  CHECK(*read[0] - *at_rest[0] == doctest::Approx(glm::degrees(0.7)));
  CHECK(*at_rest[0] == doctest::Approx(20).epsilon(0.02));
  CHECK_FALSE(read[1].has_value());
  const AngleRange range = range_of_motion(rig, frames, knee, 0);
  CHECK(range.low == doctest::Approx(*at_rest[0] - glm::degrees(0.4)));
  CHECK(range.high == doctest::Approx(*at_rest[0] + glm::degrees(2.0)));
  // Once the knee turns across its hinge, all of its angles are read, and they reproduce the pose.
  pose.rotation[shank] = glm::angleAxis(0.2, glm::dvec3(0, 1, 0)) * pose.rotation[shank];
  const JointMotions across = angles_of_joint(rig, frames, pose, knee);
  REQUIRE(across[1].has_value());
  CHECK(largest_turn_between(with(rig, {{knee, across}}), pose) < 1e-6);
}

TEST_CASE("clinical angles: knees and elbows lean aside, and feet turn, as their words say, on both sides") {
  const Armature rig = body_rig();
  const glm::dvec3 left(1, 0, 0), front(0, -1, 0);
  for (const double out : {1.0, -1.0}) {
    const BodySide side = out > 0 ? BodySide::Left : BodySide::Right;
    const std::string s = out > 0 ? "Left" : "Right";
    const auto aside = [&](const SidedJoint& joint, const std::string& bone) {
      return out * glm::dot(posed_direction(rig, with(rig, {{joint, {0.0, 10.0, 0.0}}}), bone), left);
    };
    CHECK(aside({Knee, side}, s + "Shank") == doctest::Approx(-std::sin(glm::radians(10.0))));    // varus
    CHECK(aside({Elbow, side}, s + "Forearm") == doctest::Approx(std::sin(glm::radians(10.0))));  // outwards: valgus
    const Pose turned = with(rig, {{{Knee, side}, {0.0, 0.0, 20.0}}});
    const glm::dvec3 toes =
        posed_from_rest(rig, turned)[static_cast<std::size_t>(require_bone(rig, s + "Foot"))].rotation * front;
    CHECK(out * glm::dot(toes, left) == doctest::Approx(-std::sin(glm::radians(20.0))));
  }
}

TEST_CASE("clinical angles: spread fingers leave the middle finger within the palm, thumbs leave the palm") {
  const Armature rig = body_rig();
  for (const double out : {1.0, -1.0}) {
    const BodySide side = out > 0 ? BodySide::Left : BodySide::Right;
    const std::string hand = out > 0 ? "LeftHand" : "RightHand";
    JointAngles angles;
    add_joint_request(angles, out > 0 ? "left hand spread=15" : "right hand spread=15", "");
    const Pose pose = with(rig, angles);
    const double wide = glm::radians(15.0);
    // The palm faces forward (-y), with the thumb on the outer side.
    for (const auto& [finger, towards] : {std::pair{"Index1", out}, {"Ring1", -out}, {"Little1", -out}}) {
      const BodyFrames frames = body_frames(rig);
      const SidedJoint joint{finger[0] == 'I' ? Index : finger[0] == 'R' ? Ring : Little, side};
      const glm::dvec3 before = posed_direction(
                           rig, with(rig, {{joint, {std::nullopt, std::nullopt, std::nullopt, 0.0}}}), hand + finger),
                       after = posed_direction(rig, pose, hand + finger);
      CHECK(std::abs(after.y) < 1e-9);
      const double turned = std::atan2(after.x, -after.z) - std::atan2(before.x, -before.z);
      CHECK(turned == doctest::Approx(towards * wide));
    }
    const SidedJoint thumb{Thumb, side};
    const Pose out_of_palm = with(rig, {{thumb, {std::nullopt, std::nullopt, std::nullopt, 40.0}}});
    CHECK(-posed_direction(rig, out_of_palm, hand + "Thumb1").y == doctest::Approx(std::sin(glm::radians(40.0))));
    // Bending a finger keeps its spread, and spreading it keeps its bend.
    const Pose both = with_clinical_angle(rig, body_frames(rig), pose, {Index, side}, 0, 50);
    CHECK(angle_of(rig, both, {Index, side}, kSpread) == doctest::Approx(15));
    CHECK(angle_of(rig, both, {Index, side}, 0) == doctest::Approx(50));
  }
}
