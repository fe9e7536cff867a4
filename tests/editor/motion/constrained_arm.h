// SPDX-License-Identifier: AGPL-3.0-or-later
// An editor that shows an arm and a thigh on a turning trunk, with constraints.
#pragma once

#include "core/project/history.h"
#include "editor/context/selection.h"
#include "editor/motion/constrained_pose.h"
#include "editor/motion/constraint_edits.h"
#include "editor/pose/pose_edits.h"
#include "editor/shown/shown_pose.h"
#include "tests/editor/operator_proofs.h"
#include "tests/editor/small_clip.h"

namespace limber::test {

using namespace editor;

constexpr int kTrunk = 0, kUpper = 1, kFore = 2, kHand = 3, kThigh = 4;

// Makes an arm and a thigh on a trunk, in the small body.
inline Document arm() {
  Document document = small_body();
  document.armature = std::make_shared<const Armature>(Armature{{{"Trunk", -1, {0, 0, 0}, {0, 0, 20}},
                                                                 {"LeftArm", 0, {0, 0, 20}, {12, 2, 4}},
                                                                 {"LeftForeArm", 1, {12, 2, 4}, {24, -2, -10}},
                                                                 {"LeftHand", 2, {24, -2, -10}, {27, -4, -18}},
                                                                 {"LeftThigh", 0, {4, 0, 0}, {6, 0, -30}}}});
  return document;
}

// Returns the posed tail of a bone, by multiplying matrices along its chain.
inline glm::dvec3 tail_of(const Document& document, const Pose& pose, int bone) {
  glm::dvec3 place = document.armature->bones[bone].tail;
  for (int b = bone; b >= 0; b = document.armature->bones[b].parent) {
    const glm::dvec3 head = document.armature->bones[b].head;
    place = head + glm::mat3_cast(pose.rotation[b]) * (place - head);
  }
  return place + pose.root_translation;
}
inline glm::dvec3 tail_of(const Document& document, int bone) { return tail_of(document, pose_of(document), bone); }

inline Clip turning_trunk() {
  Clip clip{.name = "turn", .range_end = 30};
  clip.keys.bones["Trunk"] = {{0, {1, 0, 0, 0}}, {30, glm::angleAxis(1.0, glm::dvec3(0, 0, 1))}};
  clip.keys.bones["LeftArm"] = {{0, {1, 0, 0, 0}}, {30, glm::angleAxis(-0.6, glm::dvec3(1, 0, 0))}};
  return clip;
}

inline void open_arm(Context& editor, std::vector<Constraint> constraints, int bone, std::optional<int> target,
                     const std::function<void(Clip&)>& change = {}) {
  editor.timeline->play = {};
  editor.timeline->shows_graph = false;
  editor.timeline->auto_key = false;
  Document document = arm();
  Clip clip = turning_trunk();
  if (!constraints.empty()) clip.constraints = std::make_shared<const Constraints>(Constraints{std::move(constraints)});
  if (change) change(clip);
  document.clips = {std::make_shared<const Clip>(clip)};
  document.frame = 10;
  document.pose = pose_at_frame(document);
  editor.history->reset(std::move(document), "Open arm");
  editor.timeline->constraint.clear();
  *editor.selection = {};
  editor.selection->bone = bone;
  editor.selection->bones = {bone};
  if (target) editor.selection->bones.insert(*target);
}

inline Constraint planted_hand(double weight = 1) {
  return {.name = "Plant LeftHand",
          .kind = ConstraintKind::Plant,
          .weight = weight,
          .bone = "LeftHand",
          .target = "LeftThigh",
          .place{9, -6, -8}};
}

inline const std::map<int, double>& weights(Context& editor) {
  static const std::map<int, double> kNone;
  const auto& all = shown_clip(editor.document())->keys.weights;
  return all.empty() ? kNone : all.begin()->second;
}

struct ArmEditor : SmallEditor {
  explicit ArmEditor(std::vector<Constraint> constraints = {}, int bone = kHand, std::optional<int> target = {})
      : SmallEditor({1280, 900}, {}, false) {
    open_arm(*editor, std::move(constraints), bone, target);
    play("key Ctrl+3\n wait-idle");
  }
  const Document& document() { return editor->document(); }
  glm::dvec3 place() {
    const Constraint& plant = constraints_of(document()).list[0];
    Document other = document();
    Armature rig = *other.armature;
    rig.bones[kThigh].tail = plant.place;
    other.armature = std::make_shared<const Armature>(rig);
    return tail_of(other, kThigh);
  }
};

}  // namespace limber::test
