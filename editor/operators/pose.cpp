// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/error.h"
#include "editor/form.h"
#include "editor/icons.h"
#include "editor/operators/polls.h"

namespace limber::editor {

namespace {

std::string needs_rig(const Editor& editor) { return editor.document().armature ? "" : "Import a rig first"; }

std::string needs_pose(const Editor& editor) {
  const Document& document = editor.document();
  if (!document.armature) return "Import a rig first";
  return document.pose && *document.pose != rest_pose(*document.armature) ? "" : "The rig is at rest";
}

void clear_pose(Editor& editor) {
  Document next = editor.document();
  next.pose.reset();
  editor.history.commit("Clear pose", std::move(next));
}

Pose pose_of(const Document& document) { return document.pose ? *document.pose : rest_pose(*document.armature); }

void ask_flex(Editor& editor) {
  std::vector<std::string> names;
  for (const Bone& bone : editor.document().armature->bones) names.push_back(bone.name);
  int chosen = editor.selection.bone.value_or(-1);
  // A bone that bends by itself, such as a forearm, where none is chosen.
  if (chosen < 0 || chosen >= std::ssize(names)) {
    chosen = 0;
    for (int b = 0; b < std::ssize(names); ++b)
      if (editor.document().armature->bones[b].limits.type == JointLimits::Type::Hinge) {
        chosen = b;
        break;
      }
  }
  const auto outcome = [](const Editor& e, const std::vector<FormField>& fields) {
    if (!e.document().armature || fields[0].chosen >= std::ssize(e.document().armature->bones)) throw Error("the rig was changed", "flex", "open this again");
    flex_axis(*e.document().armature, fields[0].chosen);
    const JointLimits& limits = e.document().armature->bones[fields[0].chosen].limits;
    if (limits.type != JointLimits::Type::Hinge) return std::string("Turned about the axis across its parent, on top of the pose it has.");
    char text[96];
    std::snprintf(text, sizeof text, "A hinge, from %.0f\u00b0 to %.0f\u00b0. Turned on top of the pose it has.", glm::degrees(limits.minimum), glm::degrees(limits.maximum));
    return std::string(text);
  };
  const auto act = [](Editor& e, const std::vector<FormField>& fields) {
    Document next = e.document();
    Pose pose = pose_of(next);
    flex(pose, *next.armature, fields[0].chosen, fields[1].value);
    next.pose = std::make_shared<const Pose>(std::move(pose));
    const std::string name = next.armature->bones[fields[0].chosen].name;
    e.history.commit("Flex " + name, std::move(next));
    e.touch();
  };
  editor.open_dialog(make_form({"Flex a joint", "Turns a bone about its hinge. Positive bends further.", "Flex",
                                {choice_of("Bone", "The bone that is turned about its head.", names, chosen), number_of("Angle", "By how much, on top of the pose it has.", 60, -180, 180, "%+.1f", "\u00b0")},
                                outcome, act}));
}

}  // namespace

std::vector<Operator> pose_operators() {
  return {
      {"pose.flex", "Flex a joint...", icon::kRotate, "Pose", "Turns a bone about its hinge by an angle.", ask_flex, needs_rig},
      {"pose.clear", "Clear pose", icon::kUndo, "Pose", "Every bone goes back to rest.", clear_pose, needs_pose},
  };
}

}  // namespace limber::editor
