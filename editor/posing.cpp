// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/posing.h"

#include <algorithm>
#include <numeric>

#include "core/rig/joint_limits.h"
#include "core/rig/mirror.h"
#include "editor/handling.h"
#include "editor/live_pose.h"
#include "editor/painting.h"
#include "editor/project.h"
#include "editor/skin_display.h"
#include "editor/test_pose.h"
#include "editor/timeline.h"

namespace limber::editor {

Pose pose_of(const Document& document) { return document.pose ? *document.pose : rest_pose(*document.armature); }

Pose shown_pose(const Editor& editor) {
  if (editor.views->preview_pose) return *editor.views->preview_pose;
  return editor.workspace == Workspace::Skin ? test_pose(editor) : pose_of(editor.document());
}

Pose seen_pose(const Editor& editor) {
  const Pose& seen = editor.live->pose();
  const bool is_of_rig = seen.rotation.size() == editor.document().armature->bones.size();
  return is_of_rig && !shown_result(editor) ? seen : shown_pose(editor);
}

std::vector<int> chosen_bones(const Editor& editor) {
  const std::shared_ptr<const Armature> armature = editor.document().armature;
  if (!armature) return {};
  std::vector<int> bones(editor.selection.bones.begin(), editor.selection.bones.end());
  std::erase_if(bones, [&](int bone) { return bone >= std::ssize(armature->bones); });
  if (bones.empty()) {
    bones.resize(armature->bones.size());
    std::iota(bones.begin(), bones.end(), 0);
  }
  return bones;
}

std::vector<int> topmost(const Armature& armature, const std::vector<int>& bones) {
  std::vector<bool> chosen(armature.bones.size(), false), below(armature.bones.size(), false);
  for (int bone : bones) chosen[bone] = true;
  std::vector<int> top;
  for (int bone = 0; bone < std::ssize(armature.bones); ++bone) {
    const int parent = armature.bones[bone].parent;
    below[bone] = parent >= 0 && (below[parent] || chosen[parent]);
    if (chosen[bone] && !below[bone]) top.push_back(bone);
  }
  return top;
}

int limb_of(const Armature& armature, int bone) {
  int length = 1;
  for (int b = bone; armature.bones[b].parent >= 0; ++length) {
    const int parent = armature.bones[b].parent;
    const auto children = std::count_if(armature.bones.begin(), armature.bones.end(), [&](const Bone& other) { return other.parent == parent; });
    if (children > 1) break;
    b = parent;
  }
  return length;
}

Pose mirrored_too(const Editor& editor, const Pose& before, Pose next) {
  if (!editor.handling->x_mirror) return next;
  const Armature& armature = *editor.document().armature;
  const std::vector<int> pairs = mirror_pairs(armature);
  const MirrorPlane plane = mirror_plane(armature);
  const Pose turned = next;
  for (int bone = 0; bone < std::ssize(pairs); ++bone) {
    const int other = pairs[bone];
    // Where both sides were turned, each keeps its own.
    if (other == bone || turned.rotation[bone] == before.rotation[bone] || turned.rotation[other] != before.rotation[other]) continue;
    next.rotation[other] = plane.rotation(turned.rotation[bone]);
    if (editor.posing.keep_limits) next.rotation[other] = within_limits(armature.bones[other], next.rotation[other]);
  }
  return next;
}

Pose limited(const Editor& editor, Pose pose, const std::vector<int>& bones) {
  if (!editor.posing.keep_limits) return pose;
  const Armature& armature = *editor.document().armature;
  for (int bone : bones) pose.rotation[bone] = within_limits(armature.bones[bone], pose.rotation[bone]);
  return pose;
}

void show_pose(Editor& editor, Pose pose) {
  editor.views->preview_pose = std::make_shared<const Pose>(std::move(pose));
  editor.touch();
}

void drop_shown_pose(Editor& editor) {
  editor.views->preview_pose.reset();
  editor.touch();
}

void commit_pose(Editor& editor, const std::string& label, Pose pose) { commit_pose(editor, label, std::move(pose), editor.document()); }

void commit_pose(Editor& editor, const std::string& label, Pose pose, Document next) {
  drop_shown_pose(editor);
  // What was posed stays in sight.
  if (editor.workspace == Workspace::Skin) editor.skin->painting->test = {.posed = true};
  if (const Pose before = pose_of(next); pose != before) {
    if (editor.timeline->auto_key) key_changes(next, before, pose);
    next.pose = pose == rest_pose(*next.armature) ? nullptr : std::make_shared<const Pose>(std::move(pose));
  }
  if (next != editor.document()) commit(editor, label, std::move(next));
}

const Anchors& anchors_of(const Document& document) {
  static const Anchors kNone;
  return document.anchors ? *document.anchors : kNone;
}

glm::dmat3 posed_axes(const Armature& armature, const Pose& pose, int bone) {
  return glm::mat3_cast(posed_from_rest(armature, pose)[bone].rotation) * rest_axes(armature.bones[bone]);
}

glm::dvec3 own_angles(const Bone& bone, const glm::dquat& rotation) {
  const glm::dquat axes = glm::quat_cast(rest_axes(bone));
  return glm::degrees(glm::eulerAngles(glm::conjugate(axes) * rotation * axes));
}

glm::dquat turned_by_own_angles(const Bone& bone, const glm::dvec3& degrees) {
  const glm::dquat axes = glm::quat_cast(rest_axes(bone));
  return glm::normalize(axes * glm::dquat(glm::radians(degrees)) * glm::conjugate(axes));
}

}  // namespace limber::editor
