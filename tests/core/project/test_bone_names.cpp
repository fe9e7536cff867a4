// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/bone_names.h"

#include <doctest/doctest.h>

#include "core/motion/constraint.h"
#include "core/rig/edit_armature.h"
#include "core/rig/mirror.h"
#include "tests/support/documents.h"
#include "tests/support/walker.h"

using namespace limber;
using namespace limber::test;

namespace {

std::shared_ptr<const Armature> with_name(const Armature& armature, const std::string& bone, const std::string& name) {
  return std::make_shared<const Armature>(renamed(armature, require_bone(armature, bone), name));
}

void rename(Document& document, const std::string& bone, const std::string& name) {
  const auto before = document.armature;
  document.armature = with_name(*before, bone, name);
  follow_names(document, *before, *document.armature);
}

// Returns the largest difference between two clips' poses over all frames of their motion.
double largest_difference(const ClipOnRig& a, const ClipOnRig& b) {
  double largest = 0;
  for (int frame = 0; frame < a.clip()->motion->frame_count; ++frame) {
    const Pose ours = a.at(frame), theirs = b.at(frame);
    for (std::size_t bone = 0; bone < ours.rotation.size(); ++bone)
      largest = std::max(largest, 1 - std::abs(glm::dot(ours.rotation[bone], theirs.rotation[bone])));
    largest = std::max(largest, glm::length(ours.root_translation - theirs.root_translation));
  }
  return largest;
}

}  // namespace

TEST_CASE(
    "bone names: a clip moves the rig as before, whatever bones are called, and names that still say all are left to "
    "speak") {
  for (const Travel travel : {Travel::Locked, Travel::Free}) {
    Document document;
    document.armature = std::make_shared<const Armature>(hanging_body());
    Clip clip =
        clip_of(std::make_shared<const Motion>(t_pose_body({{0, 0, 0}, {5, -8, 3}, {11, 4, -6}, {2, 9, 14}})), "walk");
    clip.retarget.travel = travel;
    document.clips = {std::make_shared<const Clip>(clip)};
    const ClipOnRig before(document.clips[0], document.armature);
    REQUIRE(before.retarget());

    rename(document, "LeftForearm", "lower_arm.L");
    CHECK(document.clips[0]->map.sources.empty());
    CHECK(largest_difference(before, ClipOnRig(document.clips[0], document.armature)) < 1e-12);
    // Some of the new names mean nothing, others mean another bone.
    for (const auto& [bone, name] : {std::pair{"LeftThigh", "a"},
                                     {"RightFoot", "b"},
                                     {"SpineMiddle", "c"},
                                     {"RightHand", "Tail"},
                                     {"Pelvis", "d"},
                                     {"LeftShank", "Head"},
                                     {"SpineTop", "e"}}) {
      CAPTURE(bone);
      rename(document, bone, name);
      CHECK(!document.clips[0]->map.sources.empty());
      CHECK(largest_difference(before, ClipOnRig(document.clips[0], document.armature)) < 1e-9);
    }
  }
}

TEST_CASE("bone names: a bone that gets a name the motion knows is moved by it") {
  Document document;
  document.armature = with_name(hanging_body(), "LeftHand", "unknown");
  document.clips = {
      std::make_shared<const Clip>(clip_of(std::make_shared<const Motion>(t_pose_body({{5, -8, 3}})), "walk"))};
  const int hand = require_bone(*document.armature, "unknown");
  CHECK(ClipOnRig(document.clips[0], document.armature).retarget()->joint_of(hand) < 0);
  rename(document, "unknown", "LeftHand");
  CHECK(ClipOnRig(document.clips[0], document.armature).retarget()->joint_of(hand) >= 0);
}

TEST_CASE("bone names: keys, maps, poses of the library and pins go with their bones, also where two change names") {
  Document document = small_document();
  const Document before = document;
  Armature swapped = *document.armature;
  std::swap(swapped.bones[0].name, swapped.bones[1].name);
  follow_names(document, *before.armature, swapped);
  const Clip &clip = *document.clips[0], &old = *before.clips[0];
  CHECK(clip.keys.bones.at("Upper") == old.keys.bones.at("Lower"));
  CHECK(!clip.keys.bones.contains("Lower"));
  CHECK(clip.keys.shapes.at("Upper") == old.keys.shapes.at("Lower"));
  CHECK(clip.map.sources.at("Upper") == old.map.sources.at("Lower"));
  CHECK(document.poses[0]->rotation ==
        std::map<std::string, glm::dquat>{{"Upper", before.poses[0]->rotation.at("Lower")}});
  CHECK(document.anchors->pins == std::set<std::string>{"Upper", "gone \xff"});
  CHECK(document.anchors->poles.begin()->first == "Upper");
  CHECK(document.locks->bones == std::set<std::string>{"Upper", "gone \xff"});
  CHECK(document.clips[1] == before.clips[1]);  // a clip that names no bone is not copied

  // Renaming the bones back restores all that referred to the old names.
  follow_names(document, swapped, *before.armature);
  CHECK(document.poses[0]->rotation == before.poses[0]->rotation);
  CHECK(*document.anchors == *before.anchors);
  CHECK(*document.locks == *before.locks);
  CHECK(document.clips[0]->keys == old.keys);
}

TEST_CASE("bone names: the curve of a mirrored bone is the mirror image of its curve, at every frame") {
  Document document;
  Armature rig;
  rig.bones = {{"Trunk", -1, {0, 0, 0}, {0, 0, 100}}, {"Arm.L", 0, {20, 0, 90}, {60, 5, 90}}};
  document.armature = std::make_shared<const Armature>(rig);
  Clip clip{.name = "keys"};
  clip.keys.bones["Arm.L"] = {{0, {1, 0, 0, 0}}, {20, glm::angleAxis(0.8, glm::normalize(glm::dvec3(1, 2, 3)))}};
  set_shape(clip.keys, "Arm.L", 0, {Interpolation::Bezier, HandleKind::Free, {}, {0.1, -0.02, 0.03}});
  set_shape(clip.keys, "Arm.L", 20, {Interpolation::Linear, HandleKind::Free, {0.02, 0.05, -0.07}, {}});
  document.clips = {std::make_shared<const Clip>(clip)};
  const Document before = document;
  const MirrorPlane plane = mirror_plane(rig);
  Armature mirrored = rig;
  mirrored.bones[1] = mirror_image(rig.bones[1], plane);
  mirrored.bones[1].name = "Arm.R";
  follow_mirrored(document, rig, mirrored, {1});
  const auto after = std::make_shared<const Armature>(mirrored);
  for (int frame = 0; frame <= 20; ++frame) {
    const glm::dquat was = ClipOnRig(before.clips[0], before.armature).at(frame).rotation[1];
    const glm::dquat is = ClipOnRig(document.clips[0], after).at(frame).rotation[1];
    CHECK(std::abs(glm::dot(is, plane.rotation(was))) > 1 - 1e-12);
  }
}

TEST_CASE("bone names: a mirrored bone inherits nothing of a removed bone whose name it takes") {
  Document document;
  Armature rig;
  rig.bones = {{"Trunk", -1, {0, 0, 0}, {0, 0, 100}}, {"Arm.L", 0, {20, 0, 90}, {60, 5, 90}}};
  document.armature = std::make_shared<const Armature>(rig);
  Clip clip{.name = "keys"};
  clip.keys.bones["Arm.L"] = {{5, {1, 0, 0, 0}}, {20, {0, 1, 0, 0}}};
  set_shape(clip.keys, "Arm.L", 20, {.next = Interpolation::Bezier});
  clip.keys.bones["Arm.R"] = {{3, {0, 0, 0, 1}}};
  document.clips = {std::make_shared<const Clip>(clip)};
  Armature mirrored = rig;
  mirrored.bones[1] = mirror_image(rig.bones[1], mirror_plane(rig));
  mirrored.bones[1].name = "Arm.R";
  follow_mirrored(document, rig, mirrored, {1});
  const Keys& keys = document.clips[0]->keys;
  CHECK(!keys.bones.contains("Arm.L"));
  REQUIRE(keys.bones.contains("Arm.R"));
  CHECK(frames_of(keys) == std::set<int>{5, 20});
  CHECK(shapes_of(keys, "Arm.R").contains(20));
}

TEST_CASE("bone names: a bone does not inherit the keys of a removed one whose name it takes") {
  Document document = small_document();
  Clip clip = *document.clips[0];
  clip.keys.bones["Removed"] = clip.keys.bones.at("Lower");
  document.clips = {std::make_shared<const Clip>(clip)};
  rename(document, "Upper", "Removed");
  CHECK(!document.clips[0]->keys.bones.contains("Removed"));
  CHECK(document.clips[0]->keys.bones.contains("Lower"));
}

TEST_CASE("bone names: constraints follow their bones and targets, mirrored ones as mirror images") {
  Armature rig;
  rig.bones = {{"Trunk", -1, {0, 0, 0}, {0, 0, 100}}, {"Arm.L", 0, {20, 0, 90}, {60, 5, 90}, 0.4}};
  Document document;
  document.armature = std::make_shared<const Armature>(rig);
  Constraint aim{.name = "Aim", .kind = ConstraintKind::Aim, .bone = "Arm.L", .target = "Trunk", .place{50, -80, 40}};
  Constraint limit{.name = "Limit", .kind = ConstraintKind::LimitRotation, .bone = "Arm.L"};
  limit.minimum = {-0.1, -0.3, -0.5};
  limit.maximum = {0.2, 0.4, 0.6};
  const Constraint left_over{.name = "Old", .kind = ConstraintKind::Aim, .bone = "Arm.R"};
  Clip clip{.name = "keys"};
  clip.constraints = std::make_shared<const Constraints>(Constraints{{aim, limit, left_over}});
  clip.keys.weights = {{"Aim", {{0, 0.5}, {20, 1}}}, {"Old", {{3, 1}}}};
  document.clips = {std::make_shared<const Clip>(clip)};

  Document renamed = document;
  rename(renamed, "Trunk", "Chest");
  CHECK(renamed.clips[0]->constraints->list[0].target == "Chest");
  CHECK(renamed.clips[0]->constraints->list.size() == 3);
  rename(renamed, "Chest", "Arm.R");  // a bone takes the name that a constraint without a bone refers to
  CHECK(renamed.clips[0]->constraints->list.size() == 2);
  CHECK(!renamed.clips[0]->keys.weights.contains("Old"));

  const MirrorPlane plane = mirror_plane(rig);
  Armature mirrored = rig;
  mirrored.bones[1] = mirror_image(rig.bones[1], plane);
  mirrored.bones[1].name = "Arm.R";
  const Document before = document;
  follow_mirrored(document, rig, mirrored, {1});
  CHECK(document.clips[0]->constraints->list.size() == 2);
  CHECK(document.clips[0]->keys.weights == std::map<std::string, std::map<int, double>>{{"Aim", {{0, 0.5}, {20, 1}}}});
  // A target position moves to the other side with the bone that it is fixed to. It stays if that bone stays.
  Document targets = before;
  Constraint from_trunk{
      .name = "A", .kind = ConstraintKind::Aim, .bone = "Trunk", .target = "Arm.L", .place{60, 5, 90}},
      to_leg{.name = "B", .kind = ConstraintKind::Plant, .bone = "Arm.L", .target = "Leg.R", .place{-20, 3, 8}};
  from_trunk.rotation = glm::angleAxis(0.3, glm::dvec3(0, 0, 1));
  clip.constraints = std::make_shared<const Constraints>(Constraints{{from_trunk, to_leg}});
  targets.clips = {std::make_shared<const Clip>(clip)};
  follow_mirrored(targets, rig, mirrored, {1});
  const std::vector<Constraint>& over = targets.clips[0]->constraints->list;
  CHECK(over[0].target == "Arm.R");
  CHECK(glm::distance(over[0].place, mirrored.bones[1].tail) < 1e-9);
  CHECK(std::abs(glm::dot(over[0].rotation, glm::angleAxis(-0.3, glm::dvec3(0, 0, 1)))) > 1 - 1e-12);
  CHECK(over[0].axes == from_trunk.axes);
  CHECK(over[1].bone == "Arm.R");
  CHECK(over[1].place == to_leg.place);
  // Constraint names that contain kind and bone get the new bone's name, and so do the keys of their weights. Names
  // that the user chose stay.
  Constraint first = to_leg, second = to_leg, own = to_leg;
  first.name = "Plant Arm.L";
  second.name = "Plant Arm.L 2";
  own.name = "Plant Arm.L at last";
  clip.constraints = std::make_shared<const Constraints>(Constraints{{first, second, own}});
  clip.keys.weights = {{"Plant Arm.L", {{1, 0.25}}}, {"Plant Arm.L 2", {{2, 0.5}}}};
  Document called = before;
  called.clips = {std::make_shared<const Clip>(clip)};
  Document mirrored_names = called;
  rename(called, "Arm.L", "Upper");
  follow_mirrored(mirrored_names, rig, mirrored, {1});
  for (const auto& [now, bone] : {std::pair{called, "Upper"}, {mirrored_names, "Arm.R"}}) {
    const std::string name = std::string("Plant ") + bone;
    const std::vector<Constraint>& list = now.clips[0]->constraints->list;
    CHECK(list[0].name == name);
    CHECK(list[1].name == name + " 2");
    CHECK(list[2].name == "Plant Arm.L at last");
    CHECK(now.clips[0]->keys.weights ==
          std::map<std::string, std::map<int, double>>{{name, {{1, 0.25}}}, {name + " 2", {{2, 0.5}}}});
  }
  // The arm's constraint, whose target is fixed to the trunk, turns the mirrored arm by the mirror image of its old
  // rotation.
  const auto after = std::make_shared<const Armature>(mirrored);
  for (const int frame : {0, 9, 20}) {
    const glm::dquat was = ClipOnRig(before.clips[0], before.armature).at(frame).rotation[1];
    const glm::dquat is = ClipOnRig(document.clips[0], after).at(frame).rotation[1];
    CHECK(std::abs(was.w) < 0.999);
    CHECK(std::abs(glm::dot(is, plane.rotation(was))) > 1 - 1e-9);
  }
}
