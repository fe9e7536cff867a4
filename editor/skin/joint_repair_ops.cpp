// SPDX-License-Identifier: AGPL-3.0-or-later
// The operator that repairs the joint of the active bone.
#include <algorithm>

#include "editor/context/operator.h"
#include "editor/skin/joint_repair.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

std::string needs_joint(const Editor& editor) {
  if (editor.workspace != Workspace::Skin) return "Switch to the Skin workspace first";
  if (!seen_weights(editor)) return "Compute the weights first";
  const auto& bones = editor.document().armature->bones;
  const auto& names = editor.document().weights->bones();
  if (!std::equal(bones.begin(), bones.end(), names.begin(), names.end(),
                  [](const Bone& bone, const std::string& name) { return bone.name == name; }))
    return "The weights belong to another rig: compute them again";
  const std::optional<int> bone = skin_bone(editor);
  if (!bone) return "Select the bone below the joint first";
  if (bones[static_cast<std::size_t>(*bone)].parent < 0) return "This bone has no joint: select a bone with a parent";
  return repairs_joint(editor) ? "A joint is being repaired" : "";
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
