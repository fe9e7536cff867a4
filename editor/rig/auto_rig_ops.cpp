// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that place a skeleton in the volume and fit the skeleton's joints.
#include "core/project/document.h"
#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/selection.h"
#include "editor/context/transform_settings.h"
#include "editor/context/workspace.h"
#include "editor/rig/auto_rig.h"
#include "editor/rig/joint_axis_fit.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

// A skeleton is fitted to tissue, which a bare CT or MR lacks until it has labels.
std::string needs_labels(const Context& context) {
  if (const std::string why = needs_volume(context); !why.empty()) return why;
  const auto& tissues = context.document().tissues;
  return tissues && tissues->tissues.empty() ? "The volume has no labels: make or paint labels first" : "";
}

std::string needs_joint_in_tissue(const Context& context) {
  if (context.workspace() != Workspace::Rig) return "Switch to the Rig workspace first";
  if (const std::string why = needs_bone(context); !why.empty()) return why;
  const Bone& bone = context.document().armature->bones[*context.selection->bone];
  if (bone.parent < 0) return "A root bone has no joint: select a bone that has a parent";
  return needs_volume(context);
}

std::string needs_proposed_joint(const Context& context) {
  return proposed_joint(context) ? "" : "Fit a joint's axis first";
}

Operator shows_proposed(const char* id, const char* label, const char* description, bool after) {
  return {id,
          label,
          "",
          "Rig",
          description,
          [after](Context& c) { c.transform_settings->proposed_joint->shows_after = after; },
          needs_proposed_joint,
          [after](const Context& c) { return proposed_joint(c) && proposed_joint(c)->shows_after == after; }};
}

}  // namespace

std::vector<Operator> rig_fit_operators() {
  return {
      {"rig.auto_fit", "Auto-fit rig...", kAutoFitIcon, "Rig",
       "Fit a rig (skeleton) to the volume automatically. Its joints are found from the bones or the body's shape.",
       ask_auto_fit, needs_labels},
      {"rig.templates", "Templates...", icon::kRig, "Rig", "Add a ready-made rig (skeleton), scaled to the tissue.",
       ask_template, needs_labels},
      {"rig.fit_joint_axis", "Fit joint axis", kFitAxisIcon, "Rig",
       "Find the hinge axis about which the selected bone turns with the fewest collisions of bones, and show where "
       "bones still collide.",
       start_joint_fit, needs_joint_in_tissue},
      shows_proposed("rig.joint_fit_before", "Collisions before the fit",
                     "Show where bones collide when the joint turns about its current axis.", false),
      shows_proposed("rig.joint_fit_after", "Collisions after the fit",
                     "Show the fitted axis and where bones still collide when the joint turns about it.", true),
      {"rig.take_joint_fit", "Move the joint's axis", icon::kTick, "Rig", "Move the joint's axis to the fitted axis.",
       take_proposed_joint, needs_proposed_joint},
      {"rig.leave_joint_fit", "Keep the joint's axis", icon::kClose, "Rig",
       "Discard the fitted axis and keep the current one.", leave_proposed_joint, needs_proposed_joint},
  };
}

}  // namespace limber::editor
