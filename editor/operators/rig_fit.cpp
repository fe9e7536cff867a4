// SPDX-License-Identifier: AGPL-3.0-or-later
// Skeletons that are laid into the volume.
#include "editor/icons.h"
#include "editor/operators/polls.h"
#include "editor/rig_fitting.h"

namespace limber::editor {

namespace {

std::string needs_joint_in_tissue(const Editor& editor) {
  if (editor.workspace != Workspace::Rig) return "Works in the Rig workspace";
  if (const std::string why = needs_bone(editor); !why.empty()) return why;
  const Bone& bone = editor.document().armature->bones[*editor.selection.bone];
  if (bone.parent < 0) return "A root has no joint: choose a bone below one";
  if (bone.limits.type != JointLimits::Type::Hinge) return "Make the joint a hinge first";
  return needs_volume(editor);
}

}  // namespace

std::vector<Operator> rig_fit_operators() {
  return {
      {"rig.auto_fit", "Auto-fit skeleton...", kAutoFitIcon, "Rig", "Lays a skeleton into the volume by itself: joints are found from the bones or from the body's shape.", ask_auto_fit, needs_volume},
      {"rig.templates", "Templates...", icon::kRig, "Rig", "Places a ready skeleton, scaled to the tissue.", ask_template, needs_volume},
      {"rig.fit_joint_axis", "Fit joint axis", kFitAxisIcon, "Rig", "Moves the axis of the chosen bone's hinge so that its bones do not enter each other when it bends.", start_joint_fit, needs_joint_in_tissue},
  };
}

}  // namespace limber::editor
