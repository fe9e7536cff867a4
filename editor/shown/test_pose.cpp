// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/shown/test_pose.h"

#include <algorithm>
#include <cmath>

#include "editor/context/context.h"
#include "editor/context/selection.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/shown/shown_pose.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

// A joint counts as straight if the angle between a bone and its parent is at most 10 degrees. This is the angle's
// sine.
constexpr double kStraight = 0.17;

// Returns the axis about which the test pose bends a bone against its parent. For a hinge joint, this is the hinge's
// axis. For other joints, it is the normal of the plane that contains both bones. If both bones lie on a straight line,
// it is the bone's own x axis.
glm::dvec3 bend_axis(const Armature& armature, int index) {
  const Bone& bone = armature.bones[static_cast<std::size_t>(index)];
  if (bone.limits.type == JointLimits::Type::Hinge) return bone.limits.axis;
  const Bone& parent = armature.bones[static_cast<std::size_t>(bone.parent)];
  const glm::dvec3 a = parent.tail - parent.head, b = bone.tail - bone.head, across = glm::cross(a, b);
  const bool straight = glm::length(across) <= kStraight * glm::length(a) * glm::length(b);
  return straight ? rest_axes(bone)[0] : glm::normalize(across);
}

}  // namespace

bool shows_pose(const Context& context) {
  const Document& document = context.document();
  if (!document.armature) return false;
  if (context.workspace() == Workspace::Pose) return true;
  const TestPose& test = *context.trial;
  return context.workspace() == Workspace::Skin && document.weights &&
         (test.posed || test.degrees != 0 || context.views->preview_pose);
}

Pose test_pose(const Context& context) {
  const TestPose& test = *context.trial;
  const Armature& armature = *context.document().armature;
  Pose pose = test.posed ? pose_of(context.document()) : rest_pose(armature);
  const auto bone = armature.find(test.bone);
  if (test.degrees == 0 || !bone || armature.bones[static_cast<std::size_t>(*bone)].parent < 0) return pose;
  glm::dquat& rotation = pose.rotation[static_cast<std::size_t>(*bone)];
  rotation = glm::angleAxis(glm::radians(test.degrees), bend_axis(armature, *bone)) * rotation;
  return pose;
}

std::optional<int> skin_bone(const Context& context) {
  const auto& armature = context.document().armature;
  if (!armature || armature->bones.empty()) return std::nullopt;
  return context.selection->bone && *context.selection->bone < std::ssize(armature->bones) ? *context.selection->bone
                                                                                           : 0;
}

std::string why_not_bend(const Context& context) {
  if (context.workspace() != Workspace::Skin) return "Switch to the Skin workspace first";
  const auto bone = skin_bone(context);
  if (!bone) return "Import a rig first";
  if (!context.document().weights) return "Compute the weights first";
  return context.document().armature->bones[static_cast<std::size_t>(*bone)].parent < 0
             ? "A bone without a parent cannot be bent: select another bone"
             : "";
}

double bend(const Context& context) {
  const TestPose& test = *context.trial;
  const auto bone = skin_bone(context);
  return bone && context.document().armature->bones[static_cast<std::size_t>(*bone)].name == test.bone ? test.degrees
                                                                                                       : 0;
}

void set_bend(Context& context, double degrees) {
  TestPose& test = *context.trial;
  test.bone = context.document().armature->bones[static_cast<std::size_t>(*skin_bone(context))].name;
  test.degrees = std::clamp(degrees, -TestPose::kMost, TestPose::kMost);
  if (test.degrees == 0) test.before.degrees = 0;
  context.ui->touch();
}

void clear_bend(Context& context) {
  TestPose& test = *context.trial;
  test.degrees = test.before.degrees = 0;
  context.ui->touch();
}

void toggle_test_pose(Context& context) {
  TestPose& test = *context.trial;
  if (test.posed || test.degrees != 0) {
    test.before = {test.posed, test.degrees};
    test.posed = false;
    test.degrees = 0;
  } else {
    test.degrees = test.before.degrees;
    test.posed = test.before.posed || test.degrees == 0;
  }
  context.ui->touch();
}

}  // namespace limber::editor
