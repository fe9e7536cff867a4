// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/pose_io.h"

#include <numbers>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/phantom/phantom.h"
#include "core/pose/clinical_angles.h"
#include "tests/support/body_rig.h"
#include "tests/support/program.h"

using namespace limber;

namespace {
Armature two_bones() { return {{{"upper", -1, {0, 0, 0}, {0, 0, 10}}, {"lower", 0, {0, 0, 10}, {0, 3, 20}}}}; }
}  // namespace

TEST_CASE("pose: what is written reads back equal, bit for bit") {
  const test::TemporaryFolder scratch;
  const Armature rig = two_bones();
  Pose pose = rest_pose(rig);
  pose.rotation[1] = glm::angleAxis(1.234567, glm::normalize(glm::dvec3(1, -2, 0.3)));
  pose.root_translation = {0.1, -1.0 / 3, 1e-7};
  write_pose(pose, rig, scratch / "pose.json");
  const Pose read = read_pose(scratch / "pose.json", rig);
  CHECK(read == pose);
}

TEST_CASE("pose: an axis and degrees turn as the right hand does") {
  const Armature rig = two_bones();
  const Pose pose = parse_pose(R"({"bones": {"lower": {"axis": [0, 0, 2], "degrees": 90}}})", "test", rig);
  const glm::dvec3 turned = pose.rotation[1] * glm::dvec3(1, 0, 0);
  CHECK(glm::length(turned - glm::dvec3(0, 1, 0)) < 1e-15);
  CHECK(pose.rotation[0] == glm::dquat(1, 0, 0, 0));
}

TEST_CASE("pose: unknown bones, zero axes and numbers that are none are refused") {
  const Armature rig = two_bones();
  auto refused = [&](const char* text) { CHECK_THROWS_AS(parse_pose(text, "test", rig), Error); };
  refused("");
  refused("{}");
  refused(R"({"bones": {"elbow": {"axis": [0, 0, 1], "degrees": 1}}})");
  refused(R"({"bones": {"lower": {"axis": [0, 0, 0], "degrees": 1}}})");
  refused(R"({"bones": {"lower": {"axis": [0, 0, 1]}}})");
  refused(R"({"bones": {"lower": {"axis": [0, 0, "1"], "degrees": 1}}})");
  refused(R"({"bones": {"lower": {"rotation_wxyz": [0, 0, 0, 0]}}})");
  refused(R"({"bones": {"lower": {"rotation_wxyz": [1, 0, 0]}}})");
  refused(R"({"bones": {"lower": {"rotation_wxyz": [1, 0, 0, 1e999]}}})");
  refused(R"({"bones": {}, "root_translation": [1, 2]})");
}

TEST_CASE("pose: a file of clinical angles sets the joints that it names, over its bones, on any rig") {
  const Armature rig = test::body_rig();
  const Pose pose = parse_pose(R"({"angles": {"left hip": {"flexion": 80, "abduction": 5}, "knees": {"flexion": 90}},
      "bones": {"Head": {"axis": [0, 0, 1], "degrees": 10}}})",
                               "test", rig);
  const JointAngles read = clinical_angles(rig, body_frames(rig), pose);
  CHECK(*read.at({BodyJoint::Hip, BodySide::Left})[0] == doctest::Approx(80));
  CHECK(*read.at({BodyJoint::Hip, BodySide::Left})[1] == doctest::Approx(5));
  CHECK(*read.at({BodyJoint::Knee, BodySide::Right})[0] == doctest::Approx(90));
  CHECK(*read.at({BodyJoint::Neck, BodySide::Middle})[2] == doctest::Approx(10));
  const auto refusal = [&](const char* text) -> std::string {
    try {
      parse_pose(text, "test", rig);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  CHECK(refusal(R"({"angles": {"left hip": {"flexion": "90"}}})").find("finite number") != std::string::npos);
  CHECK(refusal(R"({"angles": {"left hip": {"bending": 9}}})").find("no motion") != std::string::npos);
  CHECK(refusal(R"({"angles": {"left tail": {"flexion": 9}}})").find("no joint") != std::string::npos);
  CHECK(refusal(R"({"angles": {"hip": {"flexion": 9}}})").find("left, right or both") != std::string::npos);
  // Angles for any side apply to a limb whose bone names do not say left or right.
  const Armature arm = make_arm_phantom(10).armature;
  const Pose bent = parse_pose(R"({"angles": {"left elbow": {"flexion": 60}}})", "test", arm);
  CHECK(*clinical_angles(arm, body_frames(arm), bent).at({BodyJoint::Elbow, BodySide::Middle})[0] ==
        doctest::Approx(60));
  CHECK(refusal(R"({"angles": [3]})").find("table of joints") != std::string::npos);
  CHECK(refusal(R"({"angles": {"left hip": {"flexion": 999}}})").find("not the angle") != std::string::npos);
}
