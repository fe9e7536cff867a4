// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>

#include "core/base/error.h"
#include "core/project/history.h"
#include "core/rig/mirror.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/document_edits.h"
#include "editor/context/operator_polls.h"
#include "editor/context/pose_editing.h"
#include "editor/context/selection.h"
#include "editor/context/workspace.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/motion/constrained_pose.h"
#include "editor/motion/timeline.h"
#include "editor/pose/pose_edits.h"
#include "editor/pose/pose_inbetween_ops.h"
#include "editor/pose/pose_library.h"
#include "editor/pose/pose_tools.h"
#include "editor/rig/rig_edits.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace {

std::string needs_rig(const Context& context) { return context.document().armature ? "" : "Import a rig first"; }

std::string needs_pose(const Context& context) {
  const Document& document = context.document();
  if (!document.armature) return "Import a rig first";
  return document.pose && *document.pose != rest_pose(*document.armature) ? ""
                                                                          : "The rig is at rest: pose a bone first";
}

void clear_pose(Context& context) {
  if (is_constrained(context.document())) {
    settle_frame(context);
    const Pose rest = rest_pose(*context.document().armature);
    return commit_pose(context, "Clear pose", rest, changed_bones(pose_of(context.document()), rest));
  }
  Document next = context.document();
  next.pose.reset();
  context.history->commit("Clear pose", std::move(next));
}

void ask_flex(Context& context) {
  std::vector<std::string> names;
  for (const Bone& bone : context.document().armature->bones) names.push_back(bone.name);
  int chosen = context.selection->bone.value_or(-1);
  // If no bone is selected, the dialog proposes a bone that can bend.
  if (chosen < 0 || chosen >= std::ssize(names)) {
    // Proposes the first bone with a hinge joint, such as a forearm. Without a hinge, proposes the first child bone.
    const auto& bones = context.document().armature->bones;
    const auto child = std::find_if(bones.begin(), bones.end(), [](const Bone& bone) { return bone.parent >= 0; });
    chosen = child == bones.end() ? 0 : static_cast<int>(child - bones.begin());
    for (int b = 0; b < std::ssize(names); ++b)
      if (context.document().armature->bones[b].limits.type == JointLimits::Type::Hinge) {
        chosen = b;
        break;
      }
  }
  const auto outcome = [](const Context& c, const std::vector<FormField>& fields) {
    if (!c.document().armature || fields[0].chosen >= std::ssize(c.document().armature->bones))
      throw Error("the rig was changed", "flex", "open the dialog again");
    flex_axis(*c.document().armature, fields[0].chosen);
    const JointLimits& limits = c.document().armature->bones[fields[0].chosen].limits;
    if (limits.type != JointLimits::Type::Hinge)
      return std::string(
          "Not a hinge. The bone turns about the axis at right angles to the bone and its parent. The angle is added "
          "to its current pose.");
    char text[96];
    std::snprintf(text, sizeof text, "A hinge, from %.0f\u00b0 to %.0f\u00b0. The angle is added to its current pose.",
                  glm::degrees(limits.minimum), glm::degrees(limits.maximum));
    return std::string(text);
  };
  const auto act = [](Context& c, const std::vector<FormField>& fields) {
    settle_frame(c);
    const Armature& armature = *c.document().armature;
    const std::string name = armature.bones[fields[0].chosen].name;
    Pose pose = pose_of(c.document());
    flex(pose, armature, fields[0].chosen, fields[1].value);
    commit_pose(c, "Flex " + name, std::move(pose));
    // The Rig workspace shows the body at rest, so the user would not see that the bone has turned.
    if (c.workspace() == Workspace::Rig)
      c.messages->ok(name + " is turned", "The Pose workspace shows the pose", "workspace.pose");
  };
  context.dialogs->open(
      make_form({"Flex a joint",
                 "Turns a bone about its hinge. A positive angle bends the joint further.",
                 "Flex",
                 {choice_of("Bone", "The bone that is turned about its head.", names, chosen),
                  number_of("Angle", "Angle that is added to the current pose.", 60, -180, 180, "%+.1f", "\u00b0")},
                 outcome,
                 act}));
}

std::string needs_copy(const Context& context) {
  if (const std::string why = needs_rig(context); !why.empty()) return why;
  return context.posing->copied.empty() ? "Copy a pose first" : "";
}

void clear_rotation(Context& context) {
  Pose pose = pose_of(context.document());
  const std::vector<int> bones = chosen_bones(context);
  for (int bone : bones) pose.rotation[bone] = {1, 0, 0, 0};
  commit_pose(context, "Clear rotation", std::move(pose), bones);
}

void clear_translation(Context& context) {
  Pose pose = pose_of(context.document());
  pose.root_translation = glm::dvec3(0);
  commit_pose(context, "Clear translation", std::move(pose));
}

void copy_pose(Context& context) {
  const Armature& armature = *context.document().armature;
  const Pose pose = pose_of(context.document());
  context.posing->copied.clear();
  for (int bone : chosen_bones(context)) context.posing->copied[armature.bones[bone].name] = pose.rotation[bone];
}

// Applies each copied rotation to the bone of the same name. If `flip`, applies it as a mirror image to the bone's
// counterpart on the other side of the body.
void paste_pose(Context& context, bool flip) {
  const std::shared_ptr<const Armature> armature = context.document().armature;
  Pose copied = rest_pose(*armature);
  std::vector<bool> known(armature->bones.size(), false);
  for (std::size_t b = 0; b < known.size(); ++b)
    if (const auto found = context.posing->copied.find(armature->bones[b].name);
        found != context.posing->copied.end()) {
      copied.rotation[b] = found->second;
      known[b] = true;
    }
  const std::vector<int> pairs = mirror_pairs(*armature);
  if (flip) copied = flipped(copied, *armature);
  Pose pose = pose_of(context.document());
  std::vector<int> changed;
  for (std::size_t b = 0; b < known.size(); ++b)
    if (known[flip ? pairs[b] : b]) {
      pose.rotation[b] = copied.rotation[b];
      changed.push_back(static_cast<int>(b));
    }
  commit_pose(context, flip ? "Paste flipped pose" : "Paste pose", limited(context, std::move(pose), changed), changed);
}

void flip_pose(Context& context) {
  const std::shared_ptr<const Armature> armature = context.document().armature;
  const std::vector<int> all = topmost(*armature, chosen_bones(context));
  Pose pose = flipped(pose_of(context.document()), *armature);
  pose = limited(context, std::move(pose), all);
  commit_pose(context, "Flip pose", pose, changed_bones(pose_of(context.document()), pose));
}

// The document's pose, and the same pose with the selected bones at rest.
struct Ends {
  Pose pose, rest;
};

Ends ends_of(const Context& context) {
  const Armature& armature = *context.document().armature;
  Ends ends{pose_of(context.document()), pose_of(context.document())};
  for (const int bone : chosen_bones(context)) {
    ends.rest.rotation[bone] = {1, 0, 0, 0};
    if (armature.bones[bone].parent < 0) ends.rest.root_translation = glm::dvec3(0);
  }
  return ends;
}

void push(Context& context) {
  const Ends ends = ends_of(context);
  begin_tool(
      context,
      begin_blending(
          context,
          {.label = "Push pose", .words = "away from rest", .from = ends.rest, .to = ends.pose, .base = 1, .most = 2}));
}

void relax(Context& context) {
  const Ends ends = ends_of(context);
  begin_tool(context, begin_blending(context, {.label = "Relax pose",
                                               .words = "towards rest",
                                               .from = ends.rest,
                                               .to = ends.pose,
                                               .base = 1,
                                               .slope = -1}));
}

void break_down(Context& context) {
  if (const auto blend = between_keys(context)) return begin_tool(context, begin_blending(context, *blend));
  const Ends ends = ends_of(context);
  begin_tool(
      context,
      begin_blending(
          context,
          {.label = "Breakdown", .words = "from rest to the pose", .from = ends.rest, .to = ends.pose, .begin = 0.5}));
}

void blend_to_rest(Context& context) {
  const Ends ends = ends_of(context);
  begin_tool(
      context,
      begin_blending(context,
                     {.label = "Blend to rest", .words = "of the way to rest", .from = ends.pose, .to = ends.rest}));
}

void blend_to_copied(Context& context) {
  const Armature& armature = *context.document().armature;
  const Pose pose = pose_of(context.document());
  Pose copied = pose;
  for (const int bone : chosen_bones(context))
    if (const auto found = context.posing->copied.find(armature.bones[bone].name);
        found != context.posing->copied.end())
      copied.rotation[bone] = found->second;
  begin_tool(context, begin_blending(context, {.label = "Blend to copied pose",
                                               .words = "of the way to the copied pose",
                                               .from = pose,
                                               .to = copied}));
}

// Commits the document with new pins and poles as one edit.
void commit_anchors(Context& context, const std::string& label, Anchors anchors) {
  Document next = context.document();
  next.anchors = std::make_shared<const Anchors>(std::move(anchors));
  commit(context, label, std::move(next));
}

void toggle_pins(Context& context) {
  Anchors anchors = anchors_of(context.document());
  const Armature& armature = *context.document().armature;
  const std::vector<int> bones = chosen_bones(context);
  const bool all = std::all_of(bones.begin(), bones.end(),
                               [&](int bone) { return anchors.pins.contains(armature.bones[bone].name); });
  for (const int bone : with_other_sides(context, bones)) {
    if (all) anchors.pins.erase(armature.bones[bone].name);
    else anchors.pins.insert(armature.bones[bone].name);
  }
  const std::string what = bones.size() == 1 ? armature.bones[bones[0]].name : std::to_string(bones.size()) + " joints";
  commit_anchors(context, (all ? "Unpin " : "Pin ") + what, std::move(anchors));
}

// Returns the position of a new pole (the point towards which the limb's middle joint is bent), world coordinates in
// mm. It lies beyond the limb's middle joint, on the side to which that joint is bent now, so that adding the pole does
// not move the limb.
glm::dvec3 pole_of(const Document& document, int bone) {
  const Armature& armature = *document.armature;
  const auto posed = posed_from_rest(armature, pose_of(document));
  int root = bone;
  for (int i = 1; i < limb_of(armature, bone); ++i) root = armature.bones[root].parent;
  const glm::dvec3 begin = posed[root] * armature.bones[root].head, end = posed[bone] * armature.bones[bone].tail,
                   middle = posed[bone] * armature.bones[bone].head;
  const glm::dvec3 along = end - begin;
  const double squared = glm::dot(along, along);
  glm::dvec3 out = squared > 0 ? middle - begin - along * (glm::dot(middle - begin, along) / squared) : glm::dvec3(0);
  // The middle joint of a straight limb gives no direction, so the pole is put in front of the limb (anterior, -y).
  if (glm::length(out) < 1e-3) out = {0, -1, 0};
  return middle + glm::normalize(out) * std::max(20.0, std::sqrt(squared) / 2);
}

// Returns `bone`. With X-mirror on, also returns the bone's counterpart on the other side of the body if the
// counterpart is the last bone of a limb with at least two bones.
std::vector<int> limbs_of(const Context& context, int bone) {
  std::vector<int> bones = with_other_sides(context, {bone});
  std::erase_if(bones, [&](int other) { return other != bone && limb_of(*context.document().armature, other) < 2; });
  return bones;
}

void toggle_pole(Context& context) {
  const Armature& armature = *context.document().armature;
  const std::string& name = armature.bones[*context.selection->bone].name;
  Anchors anchors = anchors_of(context.document());
  const bool had = anchors.poles.contains(name);
  for (const int bone : limbs_of(context, *context.selection->bone)) {
    if (had) anchors.poles.erase(armature.bones[bone].name);
    else anchors.poles.insert({armature.bones[bone].name, pole_of(context.document(), bone)});
  }
  commit_anchors(context, (had ? "Remove pole of " : "Add pole to ") + name, std::move(anchors));
}

// Pins the end of the active bone's limb, and adds a pole towards which the limb's middle joint is bent.
void add_ik(Context& context) {
  const Armature& armature = *context.document().armature;
  const int bone = *context.selection->bone;
  Anchors anchors = anchors_of(context.document());
  for (const int end : limbs_of(context, bone)) {
    anchors.pins.insert(armature.bones[end].name);
    anchors.poles.insert({armature.bones[end].name, pole_of(context.document(), end)});
  }
  if (anchors != anchors_of(context.document()))
    commit_anchors(context, "Hold " + armature.bones[bone].name + " by IK", std::move(anchors));
}

// Removes the pins and poles of the selected bones; with X-mirror on, also those of the other side. When no bone is
// selected, removes all pins and poles.
void clear_ik(Context& context) {
  Anchors anchors = anchors_of(context.document());
  if (context.selection->bones.empty()) anchors = {};
  for (const int bone : with_other_sides(context, chosen_bones(context))) {
    anchors.pins.erase(context.document().armature->bones[bone].name);
    anchors.poles.erase(context.document().armature->bones[bone].name);
  }
  if (anchors != anchors_of(context.document())) commit_anchors(context, "Clear IK", std::move(anchors));
}

std::string needs_anchor(const Context& context) {
  if (const std::string why = needs_rig(context); !why.empty()) return why;
  return anchors_of(context.document()) == Anchors{} ? "No joint is pinned and no limb has a pole" : "";
}

std::string needs_limb(const Context& context) {
  if (const std::string why = needs_bone(context); !why.empty()) return why;
  return limb_of(*context.document().armature, *context.selection->bone) > 1
             ? ""
             : "A pole needs a limb of two bones or more";
}

Operator space_operator(const char* id, const char* label, const char* description, Space space) {
  return {id,           label,
          icon::kSpace, "Pose",
          description,  [space](Context& c) { c.transform_settings->space = space; },
          nullptr,      [space](const Context& c) { return c.transform_settings->space == space; }};
}

}  // namespace

std::vector<Operator> pose_operators() {
  std::vector<Operator> operators = {
      {"pose.rotate", "Rotate", icon::kRotate, "Pose", "Turn the selected bones with the pointer.",
       [](Context& c) { begin_tool(c, begin_turning(c)); }, needs_bone},
      {"pose.move", "Reach", icon::kMove, "Pose",
       "Drag the end of the active bone; its limb follows. Dragging the root bone moves the body.",
       [](Context& c) { begin_tool(c, begin_dragging(c)); }, needs_bone},
      {"pose.clear_rotation", "Clear rotation", "", "Pose",
       "Return the selected bones to rest, or all bones if none is selected.", clear_rotation, needs_pose},
      {"pose.clear_translation", "Clear translation", "", "Pose", "Return the body to its rest position.",
       clear_translation, needs_pose},
      {"pose.copy", "Copy pose", icon::kCopy, "Pose",
       "Copy the rotations of the selected bones, or of all bones if none is selected.", copy_pose, needs_rig},
      {"pose.paste", "Paste pose", "", "Pose", "Paste the copied rotations to the bones of the same names.",
       [](Context& c) { paste_pose(c, false); }, needs_copy},
      {"pose.paste_flipped", "Paste flipped pose", "", "Pose",
       "Paste the copied rotations mirrored to the bones of the other side.", [](Context& c) { paste_pose(c, true); },
       needs_copy},
      {"pose.flip", "Flip pose", icon::kMirror, "Pose",
       "Swap the poses of the left and the right side of the body, mirrored.", flip_pose, needs_pose},
      {"pose.push", "Push pose", "", "Pose",
       "Exaggerate the pose of the selected bones away from rest, with the pointer or by percent.", push, needs_pose},
      {"pose.relax", "Relax pose", "", "Pose",
       "Blend the selected bones back towards rest, with the pointer or by percent.", relax, needs_pose},
      {"pose.breakdown", "Breakdown", icon::kBreakdown, "Pose",
       "Blend the selected bones between the previous and the next key, or between rest and the pose if there are no "
       "keys.",
       break_down, needs_rig},
      {"pose.blend_rest", "Blend to rest", "", "Pose", "Blend the selected bones partly back to rest.", blend_to_rest,
       needs_pose},
      {"pose.blend_copied", "Blend to copied pose", "", "Pose",
       "Blend the selected bones partly towards the copied pose.", blend_to_copied, needs_copy},
      {"pose.pin", "Pin joint", "", "Pose",
       "Keep the tails of the selected bones in place while other joints are dragged. Run again to unpin them.",
       toggle_pins, needs_bone,
       [](const Context& c) {
         return needs_bone(c).empty() &&
                anchors_of(c.document()).pins.contains(c.document().armature->bones[*c.selection->bone].name);
       }},
      {"pose.pole", "IK pole", "", "Pose",
       "Add a pole: a point that you can drag and towards which the limb bends. Run again to remove it.", toggle_pole,
       needs_limb,
       [](const Context& c) {
         return needs_bone(c).empty() &&
                anchors_of(c.document()).poles.contains(c.document().armature->bones[*c.selection->bone].name);
       }},
      {"pose.add_ik", "Hold by IK", icon::kReach, "Pose",
       "Pin the end of the active bone's limb and add a pole towards which the limb's middle joint bends.", add_ik,
       needs_limb},
      {"pose.clear_ik", "Clear IK", "", "Pose",
       "Remove the pins and poles of the selected bones, or of all bones if none is selected.", clear_ik, needs_anchor},
      {"pose.auto_ik", "Auto-IK", icon::kReach, "Pose", "Let a dragged joint move its whole limb, not only its bone.",
       [](Context& c) { c.transform_settings->auto_ik = !c.transform_settings->auto_ik; }, nullptr,
       [](const Context& c) { return c.transform_settings->auto_ik; }},
      {"edit.x_mirror", "X-mirror", icon::kMirror, "Edit",
       "Mirror every change of a bone to its counterpart on the other side.",
       [](Context& c) { c.transform_settings->x_mirror = !c.transform_settings->x_mirror; }, nullptr,
       [](const Context& c) { return c.transform_settings->x_mirror; }},
      space_operator("space.global", "Global axes", "Align gizmos and axis locks with the axes of the world.",
                     Space::Global),
      space_operator("space.local", "Local axes", "Align gizmos and axis locks with the bone's local axes.",
                     Space::Local),
      space_operator("space.parent", "Parent axes", "Align gizmos and axis locks with the axes of the parent bone.",
                     Space::Parent),
      space_operator("space.view", "View axes", "Align gizmos and axis locks with the view: right, up, towards you.",
                     Space::View),
      {"pose.limits", "Keep to joint limits", "", "Pose", "Stop joints at their limits.",
       [](Context& c) { c.posing->keep_limits = !c.posing->keep_limits; }, nullptr,
       [](const Context& c) { return c.posing->keep_limits; }},
      {"pose.flex", "Flex a joint...", icon::kRotate, "Pose", "Turn a bone about its hinge by a typed angle.", ask_flex,
       needs_rig},
      {"pose.clear", "Clear pose", icon::kUndo, "Pose", "Return every bone to rest.", clear_pose, needs_pose},
  };
  for (auto list : {pose_neighbour_operators, pose_library_operators})
    for (Operator& op : list()) operators.push_back(std::move(op));
  return operators;
}

}  // namespace limber::editor
