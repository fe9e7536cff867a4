// SPDX-License-Identifier: AGPL-3.0-or-later
// Skeletons that are laid into the volume.
#include "editor/context/operator_polls.h"
#include "editor/context/transform_settings.h"
#include "editor/rig/auto_rig.h"
#include "editor/rig/joint_axis_fit.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

std::string needs_joint_in_tissue(const Editor& editor) {
  if (editor.workspace != Workspace::Rig) return "Works in the Rig workspace";
  if (const std::string why = needs_bone(editor); !why.empty()) return why;
  const Bone& bone = editor.document().armature->bones[*editor.selection.bone];
  if (bone.parent < 0) return "A root has no joint: choose a bone below one";
  return needs_volume(editor);
}

std::string needs_proposed_joint(const Editor& editor) {
  return proposed_joint(editor) ? "" : "Fit a joint's axis first";
}

Operator shows_proposed(const char* id, const char* label, const char* description, bool after) {
  return {id,
          label,
          "",
          "Rig",
          description,
          [after](Editor& e) { e.transform_settings->proposed_joint->shows_after = after; },
          needs_proposed_joint,
          [after](const Editor& e) { return proposed_joint(e) && proposed_joint(e)->shows_after == after; }};
}

}  // namespace

std::vector<Operator> rig_fit_operators() {
  return {
      {"rig.auto_fit", "Auto-fit skeleton...", kAutoFitIcon, "Rig",
       "Lays a skeleton into the volume by itself: joints are found from the bones or from the body's shape.",
       ask_auto_fit, needs_volume},
      {"rig.templates", "Templates...", icon::kRig, "Rig", "Places a ready skeleton, scaled to the tissue.",
       ask_template, needs_volume},
      {"rig.fit_joint_axis", "Fit joint axis", kFitAxisIcon, "Rig",
       "Finds where the axis of the chosen bone's hinge must lie so that its bones do not enter each other when it "
       "bends, and shows which do.",
       start_joint_fit, needs_joint_in_tissue},
      shows_proposed("rig.joint_fit_before", "Collisions before the fit",
                     "Shows which bone enters which when the joint turns about its axis as it is.", false),
      shows_proposed("rig.joint_fit_after", "Collisions after the fit",
                     "Shows the fitted axis, and what of bone still enters other bone about it.", true),
      {"rig.take_joint_fit", "Move the joint's axis", icon::kTick, "Rig",
       "Moves the axis to where it was found; one edit.", take_proposed_joint, needs_proposed_joint},
      {"rig.leave_joint_fit", "Leave the joint's axis", icon::kClose, "Rig", "The axis stays as it is.",
       leave_proposed_joint, needs_proposed_joint},
  };
}

}  // namespace limber::editor
