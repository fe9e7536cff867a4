// SPDX-License-Identifier: AGPL-3.0-or-later
// The operator that repairs the joint of the active bone.

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/shown/test_pose.h"
#include "editor/skin/joint_repair.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_problems.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

std::string needs_joint(const Context& context) {
  if (std::string why = why_not_these_weights(context); !why.empty()) return why;
  const auto& bones = context.document().armature->bones;
  const std::optional<int> bone = skin_bone(context);
  if (!bone) return "Select the bone below the joint first";
  if (bones[static_cast<std::size_t>(*bone)].parent < 0) return "This bone has no joint: select a bone with a parent";
  return repairs_joint(context.jobs) ? "A joint is being repaired: wait until the job ends" : "";
}

}  // namespace

std::vector<Operator> joint_repair_operators() {
  return {
      {"skin.repair_joint", "Repair this joint", icon::kTick, "Weights",
       "Change the weights around the active bone's joint, on a layer of their own, so that skin, fat and muscle keep "
       "their volumes over the joint's range of motion and overlap less.",
       start_repairing_joint, needs_joint},
  };
}

}  // namespace limber::editor
