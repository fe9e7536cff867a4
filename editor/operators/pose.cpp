// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/error.h"
#include "core/rig/mirror.h"
#include "editor/form.h"
#include "editor/icons.h"
#include "editor/operators/polls.h"
#include "editor/posing.h"
#include "editor/tools/pose_tools.h"

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

std::string needs_copy(const Editor& editor) {
  if (const std::string why = needs_rig(editor); !why.empty()) return why;
  return editor.posing.copied.empty() ? "Copy a pose first" : "";
}

void begin(Editor& editor, std::unique_ptr<Modal> tool) {
  const Rect* place = editor.layout.place_of(ViewId::Body);
  editor.modal = std::move(tool);
  editor.modal_wrap = place ? PointerWrap(*place, editor.look.px(2)) : PointerWrap();
}

void clear_rotation(Editor& editor) {
  Pose pose = pose_of(editor.document());
  for (int bone : chosen_bones(editor)) pose.rotation[bone] = {1, 0, 0, 0};
  commit_pose(editor, "Clear rotation", std::move(pose));
}

void clear_translation(Editor& editor) {
  Pose pose = pose_of(editor.document());
  pose.root_translation = glm::dvec3(0);
  commit_pose(editor, "Clear translation", std::move(pose));
}

void copy_pose(Editor& editor) {
  const Armature& armature = *editor.document().armature;
  const Pose pose = pose_of(editor.document());
  editor.posing.copied.clear();
  for (int bone : chosen_bones(editor)) editor.posing.copied[armature.bones[bone].name] = pose.rotation[bone];
}

// Bones of the same names take the copied rotations; flipped, those of the other side.
void paste_pose(Editor& editor, bool flip) {
  const std::shared_ptr<const Armature> armature = editor.document().armature;
  Pose copied = rest_pose(*armature);
  std::vector<bool> known(armature->bones.size(), false);
  for (std::size_t b = 0; b < known.size(); ++b)
    if (const auto found = editor.posing.copied.find(armature->bones[b].name); found != editor.posing.copied.end()) {
      copied.rotation[b] = found->second;
      known[b] = true;
    }
  const std::vector<int> pairs = mirror_pairs(*armature);
  if (flip) copied = flipped(copied, *armature);
  Pose pose = pose_of(editor.document());
  std::vector<int> changed;
  for (std::size_t b = 0; b < known.size(); ++b)
    if (known[flip ? pairs[b] : b]) {
      pose.rotation[b] = copied.rotation[b];
      changed.push_back(static_cast<int>(b));
    }
  commit_pose(editor, flip ? "Paste flipped pose" : "Paste pose", limited(editor, std::move(pose), changed));
}

void flip_pose(Editor& editor) {
  const std::shared_ptr<const Armature> armature = editor.document().armature;
  const std::vector<int> all = topmost(*armature, chosen_bones(editor));
  Pose pose = flipped(pose_of(editor.document()), *armature);
  commit_pose(editor, "Flip pose", limited(editor, std::move(pose), all));
}

}  // namespace

std::vector<Operator> pose_operators() {
  return {
      {"pose.rotate", "Rotate", icon::kRotate, "Pose", "Turns the chosen bones with the pointer.", [](Editor& e) { begin(e, begin_turning(e)); }, needs_bone},
      {"pose.move", "Reach", icon::kMove, "Pose", "The end of the chosen bone goes with the pointer and its limb follows; the root takes the body along.",
       [](Editor& e) { begin(e, begin_dragging(e)); }, needs_bone},
      {"pose.clear_rotation", "Clear rotation", "", "Pose", "The chosen bones go back to rest; all bones where none is chosen.", clear_rotation, needs_pose},
      {"pose.clear_translation", "Clear translation", "", "Pose", "The body goes back to its place.", clear_translation, needs_pose},
      {"pose.copy", "Copy pose", icon::kCopy, "Pose", "Keeps the rotations of the chosen bones, or of all, for pasting.", copy_pose, needs_rig},
      {"pose.paste", "Paste pose", "", "Pose", "Bones of the same names take the copied rotations.", [](Editor& e) { paste_pose(e, false); }, needs_copy},
      {"pose.paste_flipped", "Paste flipped pose", "", "Pose", "The other side's bones take the copied rotations, as in a mirror.", [](Editor& e) { paste_pose(e, true); }, needs_copy},
      {"pose.flip", "Flip pose", icon::kMirror, "Pose", "The left side does what the right side did, and the right what the left did.", flip_pose, needs_pose},
      {"pose.limits", "Keep to joint limits", "", "Pose", "Joints stop where their limits end.", [](Editor& e) { e.posing.keep_limits = !e.posing.keep_limits; }, nullptr,
       [](const Editor& e) { return e.posing.keep_limits; }},
      {"pose.flex", "Flex a joint...", icon::kRotate, "Pose", "Turns a bone about its hinge by an angle.", ask_flex, needs_rig},
      {"pose.clear", "Clear pose", icon::kUndo, "Pose", "Every bone goes back to rest.", clear_pose, needs_pose},
  };
}

}  // namespace limber::editor
