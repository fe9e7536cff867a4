// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/rest_pose_kind.h"

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/motion/retarget.h"
#include "core/pose/apply_pose_as_rest.h"
#include "tests/support/program.h"
#include "tests/support/walker.h"

using namespace limber;
using namespace limber::test;

namespace {

constexpr const char* kLimbs[] = {"UpperArm", "Forearm", "Hand", "Thigh", "Shank"};
constexpr const char* kJoints[] = {"Arm", "ForeArm", "Hand", "UpLeg", "Leg"};

const std::vector<std::array<double, 3>> kFrames = {{0, 0, 0}, {10, 20, 30}, {-50, 15, 5}, {40, -40, 60}};

// Returns the body at rest in an A-pose, with its arms raised by 45 degrees.
Armature a_posed_body() {
  const Armature rig = hanging_body();
  Pose pose = rest_pose(rig);
  for (const double side : {1.0, -1.0})
    pose.rotation[require_bone(rig, side > 0 ? "LeftUpperArm" : "RightUpperArm")] =
        glm::angleAxis(-side * glm::radians(45.0), glm::dvec3(0, 1, 0));
  return with_pose_as_rest(rig, pose);
}

// Returns the motion with a rest pose in which each joint lies straight above its parent, at the same distance.
Motion as_a_stick(Motion motion) {
  for (BvhJoint& joint : motion.joints) {
    if (joint.parent >= 0) joint.offset = {0, glm::length(joint.offset), 0};
    if (joint.end_site) joint.end_site = glm::dvec3(0, glm::length(*joint.end_site), 0);
  }
  return motion;
}

// Returns the largest angle in degrees, over all frames, between the limbs of the rig and those of `truth`.
double largest_miss(const Motion& truth, const Armature& rig, const Retarget& retarget) {
  double largest = 0;
  for (int frame = 0; frame < truth.frame_count; ++frame) {
    const auto joints = forward_kinematics(truth, frame);
    const auto bones = posed_from_rest(rig, retarget.at(frame));
    for (const std::string side : {"Left", "Right"})
      for (int limb = 0; limb < 5; ++limb) {
        const int bone = require_bone(rig, side + kLimbs[limb]);
        int joint = 0;
        while (truth.joints[joint].name != side + kJoints[limb]) ++joint;
        const glm::dvec3 end =
            limb == 2 ? joints[joint] * *truth.joints[joint].end_site : joints[joint + 1].translation;
        const glm::dvec3 there = lps_from_bvh(end - joints[joint].translation),
                         here = bones[bone].rotation * (rig.bones[bone].tail - rig.bones[bone].head);
        largest = std::max(largest, glm::degrees(angle_between(here, there)));
      }
  }
  return largest;
}

double largest_miss(const Motion& truth, const Motion& given, const Armature& rig, const RestStances& stances,
                    const RetargetSettings& settings) {
  RetargetMap map = match_by_names(given, rig);
  map.stances = stances;
  return largest_miss(truth, rig, Retarget(given, rig, map, settings));
}

}  // namespace

TEST_CASE(
    "rest stance: limbs go where the actor's went, whatever rig and file show at rest, once the file's rest is named") {
  const Motion truth = t_pose_body(kFrames), stick = as_a_stick(truth);
  for (const Armature& rig : {hanging_body(), a_posed_body()})
    for (const RestStance of_rig : {RestStance::AsItLies, RestStance::APose, RestStance::Anatomical})
      for (const Reference reference : {Reference::Found, Reference::RestPose, Reference::FirstFrame})
        for (const Travel travel : {Travel::Locked, Travel::Free}) {
          const RetargetSettings settings{.travel = travel, .reference = reference};
          for (const RestStance of_file : {RestStance::AsItLies, RestStance::TPose})
            CHECK(largest_miss(truth, truth, rig, {of_file, of_rig}, settings) < 2);
          CHECK(largest_miss(truth, stick, rig, {RestStance::TPose, of_rig}, settings) < 2);
          CHECK(largest_miss(truth, stick, rig, {RestStance::AsItLies, of_rig}, settings) > 30);
        }
}

TEST_CASE("rest stance: a stick named a T-pose becomes the T-pose, which stays as it is") {
  const Motion truth = t_pose_body({{0, 0, 0}});
  CHECK(straightened(truth, RestStance::TPose, -1).turned.empty());
  const Straightened straight = straightened(as_a_stick(truth), RestStance::TPose, 0);
  CHECK(straight.turned.size() == 12);  // arms, legs and feet
  const auto is = forward_kinematics(straight.motion, 0), was = forward_kinematics(truth, 0);
  for (std::size_t j = 0; j < is.size(); ++j) {
    const int parent = truth.joints[j].parent;
    // A T-pose does not define where the arms and legs begin.
    if (parent >= 0 && truth.joints[parent].name != "Chest" && truth.joints[parent].name != "Hips")
      CHECK(glm::distance(is[j].translation - is[parent].translation, was[j].translation - was[parent].translation) <
            1e-6);
  }
  // The rest pose of a motion decides: a motion that moves but rests in the T-pose is unchanged too.
  const Motion moving = t_pose_body({{10, 20, 30}});
  CHECK(straightened(moving, RestStance::TPose, -1).turned.empty());
}

TEST_CASE("rest stance: palms that no finger shows face as is said") {
  const Motion motion = t_pose_body({{0, 0, 0}});
  const Armature rig = hanging_body();
  const auto palm = [&](RestStances stances, const glm::dvec3& at_rest, const char* hand) {
    RetargetMap map = match_by_names(motion, rig);
    map.stances = stances;
    return posed_from_rest(rig, Retarget(motion, rig, map).at(0))[require_bone(rig, hand)].rotation * at_rest;
  };
  const glm::dvec3 forward(0, -1, 0), down(0, 0, -1);
  for (const char* hand : {"LeftHand", "RightHand"}) {
    CHECK(glm::degrees(angle_between(palm({RestStance::TPose, RestStance::Anatomical}, forward, hand), down)) < 8);
    // If the rest stances are not given, the palm keeps the direction to which the arm turns it.
    CHECK(glm::degrees(angle_between(palm({}, forward, hand), forward)) < 8);
  }
  const glm::dvec3 inward(-1, 0, 0);  // the left palm faces inwards at rest, with the thumb forward
  CHECK(glm::degrees(angle_between(palm({RestStance::TPose, RestStance::APose}, inward, "LeftHand"), down)) < 8);
  CHECK(glm::degrees(angle_between(palm({RestStance::Anatomical, RestStance::TPose}, inward, "LeftHand"), forward)) <
        8);
}

TEST_CASE("rest stance: names are kept in map files and mean nothing else there") {
  const Motion motion = t_pose_body({{0, 0, 0}});
  const Armature rig = hanging_body();
  const TemporaryFolder folder;
  RetargetMap map = match_by_names(motion, rig);
  map.stances = {RestStance::TPose, RestStance::Anatomical};
  write_retarget_map(map, folder / "map.json");
  CHECK(read_retarget_map(folder / "map.json", motion, rig) == map);
  CHECK(parse_retarget_map(R"({"Spine": "SpineLow", "@rests": {"rig": "supine"}})", "test", motion, rig).stances ==
        RestStances{RestStance::AsItLies, RestStance::Anatomical});
  for (const char* bad :
       {R"({"Spine": "SpineLow", "@rests": "T"})", R"({"Spine": "SpineLow", "@rests": {"motion": "Y"}})",
        R"({"Spine": "SpineLow", "@rests": {"motion": 1}})", R"({"Spine": "SpineLow", "@rests": {"body": "T"}})",
        R"({"@rests": {"motion": "T"}})"})
    CHECK_THROWS_AS(parse_retarget_map(bad, "test", motion, rig), Error);
}
