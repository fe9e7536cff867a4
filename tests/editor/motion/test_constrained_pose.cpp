// SPDX-License-Identifier: AGPL-3.0-or-later
// Constraints hold while poses, keys and the constraints themselves are edited by hand.
#include "core/motion/motion_edit.h"
#include "core/pose/pose_io.h"
#include "editor/context/operator.h"
#include "editor/context/pose_editing.h"
#include "editor/context/transform_settings.h"
#include "tests/editor/motion/constrained_arm.h"

namespace limber::test {

TEST_CASE("constrained pose: rotations that are set under a constraint do not drift, those that are turned go on") {
  ArmEditor test({planted_hand()}, kFore);
  edit_clip(*test.editor, "Bend", PoseThen::FromClip, [](Clip& clip) {
    clip.keys.bones["LeftForeArm"] = {{0, glm::angleAxis(0.3, glm::dvec3(1, 0, 0))}};
  });
  test.editor->timeline->auto_key = true;
  const auto keyed = [&] { return shown_clip(test.editor->document())->keys.bones.at("LeftForeArm").at(10); };
  run(*test.editor, "pose.clear_rotation");
  const Pose cleared = pose_of(test.document());
  CHECK(cleared.rotation[kFore] != glm::dquat(1, 0, 0, 0));  // the planted hand still bends the elbow
  for (int time = 0; time < 3; ++time) {
    run(*test.editor, "pose.clear_rotation");
    CHECK(keyed() == glm::dquat(1, 0, 0, 0));
    CHECK(pose_of(test.document()) == cleared);
  }
  const glm::dquat copied = glm::angleAxis(0.4, glm::dvec3(0, 1, 0));
  test.editor->posing->copied = {{"LeftForeArm", copied}};
  run(*test.editor, "pose.paste");
  CHECK(keyed() == copied);
  Pose typed = pose_of(test.document());
  typed.rotation[kFore] = glm::angleAxis(0.9, glm::dvec3(0, 1, 0));
  preview_pose(*test.editor, typed, {kFore});
  const Pose previewed = shown_pose(*test.editor);
  commit_pose(*test.editor, "Type", typed, {kFore});
  CHECK(keyed() == typed.rotation[kFore]);
  CHECK(pose_of(test.document()) == previewed);
  Pose turned = pose_of(test.document());
  const glm::dquat turn = glm::angleAxis(0.2, glm::dvec3(0, 1, 0));
  turned.rotation[kFore] = turn * turned.rotation[kFore];
  commit_pose(*test.editor, "Turn", turned);
  CHECK(std::abs(glm::dot(keyed(), turn * typed.rotation[kFore])) > 1 - 1e-12);
}

TEST_CASE("constrained pose: a key of one bone keeps what was turned by hand elsewhere, and so does a marker") {
  ArmEditor test({planted_hand(0.5)}, kFore);
  Pose turned = pose_of(test.document());
  turned.rotation[kThigh] = glm::angleAxis(0.5, glm::dvec3(0, 0, 1));
  commit_pose(*test.editor, "Turn", turned);
  const Pose held = pose_of(test.document());
  const auto is_held = [&] {
    for (int bone = 0; bone < 5; ++bone)
      CHECK(std::abs(glm::dot(pose_of(test.document()).rotation[bone], held.rotation[bone])) > 1 - 1e-12);
  };
  run(*test.editor, "motion.insert_key");
  CHECK(shown_clip(test.editor->document())->keys.bones.contains("LeftForeArm"));
  CHECK(!shown_clip(test.editor->document())->keys.bones.contains("LeftThigh"));
  is_held();
  // Setting a marker changes the clip, so the pose no longer counts as read from the clip. The editor still knows the
  // pose without the constraint, so it does not apply the constraint twice.
  run(*test.editor, "pose.clear_rotation");
  const Pose cleared = pose_of(test.document());
  run(*test.editor, "motion.marker");
  CHECK(pose_of(test.document()) == cleared);
  run(*test.editor, "select.all");
  run(*test.editor, "motion.insert_key");
  for (int bone = 0; bone < 5; ++bone)
    CHECK(std::abs(glm::dot(pose_of(test.document()).rotation[bone], cleared.rotation[bone])) > 1 - 1e-12);
  CHECK(shown_clip(test.editor->document())->keys.bones.at("LeftForeArm").at(10) == glm::dquat(1, 0, 0, 0));
}

TEST_CASE("constrained pose: a flexed joint, an imported and a cleared pose are held by constraints, and keyed") {
  const TemporaryFolder folder;
  ArmEditor test({planted_hand()}, kFore);
  test.editor->timeline->auto_key = true;
  test.play(
      "click \"Edit/Pose/Flex a joint...\"\n double-click Angle/value\n type \"30\"\n key Return\n key Return\n "
      "wait-idle");
  CHECK(test.fact("edit") == "Flex LeftForeArm");
  CHECK(glm::distance(tail_of(test.document(), kHand), test.place()) < 0.01);
  // The key stores the rotation by 30 degrees, without the effect of the constraint.
  const glm::dquat keyed = shown_clip(test.editor->document())->keys.bones.at("LeftForeArm").at(10);
  CHECK(std::abs(keyed.w) == doctest::Approx(std::cos(glm::radians(15.0))));
  Pose pose = rest_pose(*test.document().armature);
  pose.rotation[kTrunk] = glm::angleAxis(-0.4, glm::dvec3(0, 0, 1));
  write_pose(pose, *test.document().armature, folder / "pose.json");
  test.play("drop " + std::string(folder / "pose.json") + "\n wait-job\n wait-idle");
  CHECK(test.fact("edit") == "Import pose.json");
  CHECK(std::abs(glm::dot(pose.rotation[kTrunk], pose_of(test.document()).rotation[kTrunk])) > 1 - 1e-9);
  CHECK(glm::distance(tail_of(test.document(), kHand), test.place()) < 0.01);
  CHECK(shown_clip(test.editor->document())->keys.bones.at("LeftForeArm").at(10) == pose.rotation[kFore]);
  run(*test.editor, "pose.clear");
  CHECK(test.fact("edit") == "Clear pose");
  CHECK(pose_of(test.document()).rotation[kTrunk] == glm::dquat(1, 0, 0, 0));
  CHECK(glm::distance(tail_of(test.document(), kHand), test.place()) < 0.01);
  CHECK(shown_clip(test.editor->document())->keys.bones.at("Trunk").at(10) == glm::dquat(1, 0, 0, 0));
}

TEST_CASE("constrained pose: a limb stays where it is when another point or its direction is planted") {
  ArmEditor test({planted_hand()});
  const Pose before = pose_of(test.document());
  const auto apart = [&](const Pose& a, const Pose& b) {
    double most = 0;
    for (const int bone : {kFore, kHand})
      most = std::max(most, glm::distance(tail_of(test.document(), a, bone), tail_of(test.document(), b, bone)));
    return most;
  };
  set_planted_point(*test.editor, "Plant LeftHand", PlantPoint::Joint);
  CHECK(apart(before, pose_of(test.document())) < 0.01);
  CHECK(glm::distance(test.place(), tail_of(test.document(), kFore)) < 0.01);
  keep_direction(*test.editor, "Plant LeftHand", false);
  Pose turned = pose_of(test.document());
  turned.rotation[kHand] = glm::angleAxis(0.8, glm::dvec3(0, 1, 0)) * turned.rotation[kHand];
  commit_pose(*test.editor, "Turn hand", turned);
  const Pose free = pose_of(test.document());
  CHECK(apart(before, free) > 1);
  keep_direction(*test.editor, "Plant LeftHand", true);
  CHECK(apart(free, pose_of(test.document())) < 0.01);
  // A forearm without a hand is planted by its tail, whichever point is selected.
  Document handless = test.document();
  Armature rig = *handless.armature;
  rig.bones.erase(rig.bones.begin() + kHand);
  handless.armature = std::make_shared<const Armature>(rig);
  handless.clips = {std::make_shared<const Clip>(turning_trunk())};
  handless.pose = pose_at_frame(handless);
  test.editor->history->reset(handless, "Handless");
  test.editor->selection->bone = kFore;
  test.editor->selection->bones = {kFore};
  run(*test.editor, "constraint.add_plant");
  const Pose planted = pose_of(test.document());
  set_planted_point(*test.editor, "Plant LeftForeArm", PlantPoint::Joint);
  CHECK(apart(planted, pose_of(test.document())) < 0.01);
  CHECK(glm::distance(constraints_of(test.document()).list[0].place, tail_of(test.document(), kFore)) < 0.01);
  test.play("wait-idle");
  CHECK_THROWS(test.play("click \"Constraints/Plant LeftForeArm/Keep direction\""));
}

TEST_CASE("constrained pose: what is left of a removed bone can be seen and removed without a selection") {
  const Constraint gone{.name = "Aim Tail", .kind = ConstraintKind::Aim, .bone = "Tail", .place{0, -50, 0}};
  ArmEditor test({gone, planted_hand()});
  *test.editor->selection = {};
  test.play("wait-idle\n click \"Constraints/Aim Tail/Remove\"\n wait-idle");
  REQUIRE(constraints_of(test.document()).list.size() == 1);
  CHECK(constraints_of(test.document()).list[0].name == "Plant LeftHand");
}

TEST_CASE("constrained pose: a switched weight has no keys between, and its last deleted key is what stays") {
  ArmEditor test({planted_hand()});
  edit_clip(*test.editor, "Weights", PoseThen::FromClip, [](Clip& clip) {
    clip.keys.weights["Plant LeftHand"] = {{0, 1}, {13, 0.7}, {16, 1}, {40, 1}};
  });
  set_weight(*test.editor, "Plant LeftHand", 1);  // at frame 10, where a key is set
  run(*test.editor, "constraint.switch");
  CHECK(weights(*test.editor) == std::map<int, double>{{0, 1}, {10, 1}, {20, 0}, {40, 1}});
  edit_clip(*test.editor, "Weights", PoseThen::FromClip, [](Clip& clip) {
    clip.keys.weights["Plant LeftHand"] = {{5, 1}, {15, 0}};
    clip.range_start = 25;
    clip.range_end = 29;
  });
  run(*test.editor, "motion.trim");
  go_to_frame(*test.editor, 27);
  CHECK(shown_weight(*test.editor, constraints_of(test.document()).list[0]) == 0);
  CHECK(weights(*test.editor) == std::map<int, double>{{25, 0}});
  test.editor->timeline->chosen = {25};
  run(*test.editor, "motion.delete_keys");
  CHECK(weights(*test.editor).empty());
  CHECK(constraints_of(test.document()).list[0].weight == 0);
}

TEST_CASE("constrained pose: a motion that does not move the rig leaves the pose to be keyed, and rest poses carry") {
  ArmEditor test;
  const Armature other{{{"Foo", -1, {0, 0, 0}, {0, 0, 9}}}};
  Document document = arm();
  document.clips = {std::make_shared<const Clip>(clip_of(
      std::make_shared<const Motion>(motion_of_poses(other, 3, 30, [&](int) { return rest_pose(other); })), "foo"))};
  Pose pose = rest_pose(*document.armature);
  pose.rotation[kTrunk] = glm::angleAxis(0.4, glm::dvec3(0, 1, 0));
  document.pose = std::make_shared<const Pose>(pose);
  test.editor->history->reset(document, "Foo");
  test.editor->selection->bones = {kHand, kThigh};
  test.editor->selection->bone = kHand;
  run(*test.editor, "constraint.add_plant");
  REQUIRE(constraints_of(test.document()).list.size() == 1);
  CHECK(shown_clip(test.editor->document())->keys.bones.at("Trunk").at(0) == pose.rotation[kTrunk]);
  // When the pose becomes the new rest pose, the hand stays planted where it is.
  const glm::dvec3 before = tail_of(test.document(), kHand);
  run(*test.editor, "pose.apply_as_rest");
  const Bone& thigh = test.document().armature->bones[kThigh];
  CHECK(glm::distance(test.document().armature->bones[kHand].tail, before) < 1e-6);
  CHECK(glm::distance(constraints_of(test.document()).list[0].place, before) < 1e-6);
  CHECK(std::abs(constraints_of(test.document()).list[0].rotation.w) > 1 - 1e-9);
  CHECK(glm::distance(thigh.tail, arm().armature->bones[kThigh].tail) > 5);
}

TEST_CASE("constrained pose: X-mirror gives a constrained counterpart the mirrored rotation, time after time") {
  ArmEditor test({}, kThigh);
  Document document = arm();
  Armature rig = *document.armature;
  Bone other = rig.bones[kThigh];
  other.name = "RightThigh";
  other.head.x *= -1;
  other.tail.x *= -1;
  rig.bones.push_back(other);
  document.armature = std::make_shared<const Armature>(rig);
  Constraint stiff{.name = "Stiff", .kind = ConstraintKind::LimitRotation, .weight = 0.5, .bone = "RightThigh"};
  stiff.minimum = stiff.maximum = glm::dvec3(0);
  Clip clip = turning_trunk();
  clip.constraints = std::make_shared<const Constraints>(Constraints{{stiff}});
  document.clips = {std::make_shared<const Clip>(clip)};
  document.frame = 10;
  document.pose = pose_at_frame(document);
  test.editor->history->reset(document, "Thighs");
  test.editor->timeline->auto_key = true;
  test.editor->transform_settings->x_mirror = true;
  for (const double degrees : {30.0, 60.0, 90.0}) {
    test.play("wait-idle\n move \"3D view/view\"\n key R\n key X\n key 3\n key 0\n key Return\n wait-idle");
    const auto& keys = shown_clip(test.editor->document())->keys.bones;
    const glm::dquat left = keys.at("LeftThigh").at(10), right = keys.at("RightThigh").at(10);
    CHECK(glm::degrees(2 * std::acos(std::abs(left.w))) == doctest::Approx(degrees));
    // The mirrored rotation has the same part about x and the opposite parts about y and z.
    CHECK(std::abs(glm::dot(right, glm::dquat(left.w, left.x, -left.y, -left.z))) > 1 - 1e-9);
    // The view shows only half of the right bone's rotation, since the constraint has weight 0.5.
    CHECK(std::abs(glm::dot(right, pose_of(test.document()).rotation[5])) < 1 - 1e-3);
  }
}

}  // namespace limber::test
