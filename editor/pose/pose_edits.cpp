// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/pose/pose_edits.h"

#include <algorithm>
#include <numeric>

#include "core/rig/joint_limits.h"
#include "core/rig/mirror.h"
#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/pose_editing.h"
#include "editor/context/transform_settings.h"
#include "editor/context/workspace.h"
#include "editor/motion/constrained_pose.h"
#include "editor/motion/timeline.h"
#include "editor/pose/live_preview.h"
#include "editor/shown/shown_result.h"
#include "editor/shown/test_pose.h"

namespace limber::editor {

Pose seen_pose(const Context& context) {
  const Pose& seen = context.live->pose();
  const bool is_of_rig = seen.rotation.size() == context.document().armature->bones.size();
  return is_of_rig && !shown_result(context) ? seen : shown_pose(context);
}

int limb_of(const Armature& armature, int bone) {
  int length = 1;
  for (int b = bone; armature.bones[b].parent >= 0; ++length) {
    const int parent = armature.bones[b].parent;
    const auto children = std::count_if(armature.bones.begin(), armature.bones.end(),
                                        [&](const Bone& other) { return other.parent == parent; });
    if (children > 1) break;
    b = parent;
  }
  return length;
}

Pose mirrored_too(const Context& context, const Pose& before, Pose next) {
  if (!context.transform_settings->x_mirror) return next;
  const Armature& armature = *context.document().armature;
  const std::vector<int> pairs = mirror_pairs(armature);
  const MirrorPlane plane = mirror_plane(armature);
  const Pose turned = next;
  for (int bone = 0; bone < std::ssize(pairs); ++bone) {
    const int other = pairs[bone];
    // If both bones of a left-right pair were turned, each of them keeps its own rotation.
    if (other == bone || turned.rotation[bone] == before.rotation[bone] ||
        turned.rotation[other] != before.rotation[other])
      continue;
    next.rotation[other] = plane.rotation(turned.rotation[bone]);
    if (context.posing->keep_limits) next.rotation[other] = within_limits(armature.bones[other], next.rotation[other]);
  }
  return next;
}

Pose limited(const Context& context, Pose pose, const std::vector<int>& bones) {
  if (!context.posing->keep_limits) return pose;
  const Armature& armature = *context.document().armature;
  for (int bone : bones) pose.rotation[bone] = within_limits(armature.bones[bone], pose.rotation[bone]);
  return pose;
}

void preview_pose(Context& context, const Pose& pose, const std::vector<int>& set) {
  show_pose(context, held_by_constraints(context, pose, set));
}

void commit_pose(Context& context, const std::string& label, Pose pose, const std::vector<int>& set) {
  commit_pose(context, label, std::move(pose), context.document(), set);
}

void commit_pose(Context& context, const std::string& label, Pose pose, Document next, const std::vector<int>& set) {
  drop_shown_pose(context);
  // In the Skin workspace, lets the views show the document's pose instead of a test pose, so that the user sees the
  // change.
  if (context.workspace() == Workspace::Skin) *context.trial = {.posed = true};
  if (const Pose before = pose_of(next); pose != before) {
    const bool constrains = is_constrained(context.document());
    const Pose free = unconstrained_pose(context, pose, set);
    if (context.timeline->auto_key) key_changes(next, constrains ? unconstrained_pose(context) : before, free);
    if (constrains) {
      pose = held_by_constraints(context, pose, set);
      remember_free_pose(context.timeline, next, pose, free);
    }
    next.pose = pose == rest_pose(*next.armature) ? nullptr : std::make_shared<const Pose>(std::move(pose));
  }
  if (next != context.document()) commit(context, label, std::move(next));
}

std::vector<int> changed_bones(const Pose& before, const Pose& after) {
  std::vector<int> bones;
  for (std::size_t bone = 0; bone < before.rotation.size(); ++bone)
    if (before.rotation[bone] != after.rotation[bone]) bones.push_back(static_cast<int>(bone));
  return bones;
}

const Anchors& anchors_of(const Document& document) {
  static const Anchors kNone;
  return document.anchors ? *document.anchors : kNone;
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
