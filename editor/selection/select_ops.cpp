// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "core/rig/mirror.h"
#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/pick_list.h"
#include "editor/context/pointer_context.h"
#include "editor/context/selection.h"
#include "editor/context/transform_settings.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/selection/area_select_tool.h"
#include "editor/selection/transform_gizmo.h"
#include "editor/shown/compare_wipe.h"
#include "editor/shown/shown_result.h"
#include "editor/ui/icons.h"
#include "editor/ui/ui.h"
#include "editor/volume/tissue_edits.h"

namespace limber::editor {

namespace {

void pick(Context& context) {
  if (context.interaction->tool == Tool::CrossHair) return run(context, "view.place_cross_hair");
  context.transform_settings->part = TransformSettings::Part::Whole;
  if (pick_bone_part(context)) return;
  if (const auto bone = bone_at_pointer(context)) return choose_bone(context, *bone);
  const Hover& hover = context.views->hover;
  if (hover.inside) select_tissue(context, hover.label, false);
  else *context.selection = {};
}

void extend(Context& context) {
  context.transform_settings->part = TransformSettings::Part::Whole;
  if (const auto bone = bone_at_pointer(context)) {
    // If the bone under the pointer is the active bone, deselect it.
    if (context.selection->bone == bone) {
      context.selection->bones.erase(*bone);
      context.selection->bone =
          context.selection->bones.empty() ? std::nullopt : std::optional(*context.selection->bones.begin());
    } else {
      context.selection->bone = bone;
      context.selection->bones.insert(*bone);
    }
    return;
  }
  if (context.views->hover.inside) select_tissue(context, context.views->hover.label, true);
}

// Returns the visible tissues under the pointer, each with its distance from the eye, mm. In the 3D view, these are all
// tissues along the line of sight, nearest first. In a slice, it is one tissue, at distance 0.
std::vector<std::pair<double, Label>> tissues_below(const Context& context) {
  const Hover& hover = context.views->hover;
  std::vector<std::pair<double, Label>> found;
  const ViewPlace* under = hovered_view(context);
  if (!hover.inside || !under) return found;
  const render::Scene& scene = scene_at_pointer(context, *under);
  const LabelVolume& volume = *scene.volume;
  const auto add = [&](double depth, Label label) {
    const bool known =
        std::any_of(found.begin(), found.end(), [&](const auto& other) { return other.second == label; });
    if (label != 0 && look_of(context.document(), label).visible && !known) found.push_back({depth, label});
  };
  if (hover.view != ViewId::Body) {
    add(0, hover.label);
    return found;
  }
  const render::Camera& camera = context.views->body.camera;
  const auto depth_of = [&](const glm::dvec3& point) {
    return -(render::view_from_world(camera) * glm::dvec4(point, 1)).z;
  };
  add(depth_of(hover.point), hover.label);
  const render::Ray ray =
      render::ray_through(camera, context.ui->input.pointer - under->rect.low, glm::ivec2(under->rect.size()));
  const double step = std::min({volume.grid.spacing.x, volume.grid.spacing.y, volume.grid.spacing.z}) / 2;
  const double reach = glm::length(volume.grid.spacing * glm::dvec3(volume.grid.size));
  for (double t = 0; t < reach; t += step) {
    const glm::dvec3 point = hover.point + ray.direction * t;
    if (const auto voxel = voxel_shown_at(scene, point)) add(depth_of(point), volume.at_or_air(*voxel));
  }
  return found;
}

// Selects the bone or tissue under the pointer, as a click does. If several bones and tissues lie under the pointer,
// opens a list of them, nearest first.
void pick_list(Context& context) {
  pick(context);
  std::vector<std::pair<double, Pickable>> below;
  for (const auto& [depth, label] : tissues_below(context)) below.push_back({depth, {std::nullopt, label}});
  for (const auto& [depth, bone] : bones_below(context)) below.push_back({depth, {bone}});
  std::stable_sort(below.begin(), below.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  context.pick_list->rows.clear();
  for (const auto& [depth, thing] : below) context.pick_list->rows.push_back(thing);
  context.pick_list->opens = context.pick_list->rows.size() > 1;
}

void add_bone(Context& context, int bone) {
  context.selection->bone = bone;
  context.selection->bones.insert(bone);
}

void go_to_parent(Context& context, bool extend) {
  const int parent = context.document().armature->bones[*context.selection->bone].parent;
  if (parent >= 0) extend ? add_bone(context, parent) : choose_bone(context, parent);
}

void go_to_child(Context& context, bool extend) {
  const std::vector<Bone>& bones = context.document().armature->bones;
  for (int b = 0; b < std::ssize(bones); ++b)
    if (bones[b].parent == *context.selection->bone) return extend ? add_bone(context, b) : choose_bone(context, b);
}

// Adds all descendants of the selected bones to the selection. One pass is enough, because an armature lists parents
// before their children.
void choose_chain(Context& context) {
  const std::vector<Bone>& bones = context.document().armature->bones;
  for (int b = 0; b < std::ssize(bones); ++b)
    if (bones[b].parent >= 0 && context.selection->bones.contains(bones[b].parent)) context.selection->bones.insert(b);
}

void choose_mirrored(Context& context) {
  const std::vector<int> pairs = mirror_pairs(*context.document().armature);
  std::set<int> bones;
  for (int bone : context.selection->bones) bones.insert(pairs[bone]);
  context.selection->bones = bones;
  context.selection->bone = pairs[*context.selection->bone];
}

void choose_all(Context& context) {
  const Document& document = context.document();
  if (document.armature && (context.workspace() == Workspace::Pose ||
                            (context.workspace() == Workspace::Rig && context.selection->tissues.empty()))) {
    for (int b = 0; b < std::ssize(document.armature->bones); ++b) context.selection->bones.insert(b);
    if (!context.selection->bone) context.selection->bone = 0;
    return;
  }
  for (const Tissue& tissue : document.tissues->tissues) context.selection->tissues.insert(tissue.label);
}

std::string needs_bones(const Context& context) {
  if (context.workspace() != Workspace::Rig && context.workspace() != Workspace::Pose)
    return "Switch to the Rig or Pose workspace first";
  return context.document().armature ? "" : "Import a rig first";
}

bool chooses_bones(const Context& context) {
  return needs_bones(context).empty() && context.selection->tissues.empty();
}

void invert(Context& context) {
  Selection& selection = context.selection;
  if (chooses_bones(context)) {
    std::set<int> others;
    for (int b = 0; b < std::ssize(context.document().armature->bones); ++b)
      if (!selection.bones.contains(b)) others.insert(b);
    selection.bone = others.empty() ? std::nullopt : std::optional(*others.begin());
    selection.bones = std::move(others);
    return;
  }
  std::set<Label> others;
  for (const Tissue& tissue : context.document().tissues->tissues)
    if (!selection.tissues.contains(tissue.label)) others.insert(tissue.label);
  selection.tissue = others.empty() ? std::nullopt : std::optional(*others.begin());
  selection.tissues = std::move(others);
}

// Selects, in addition to the selected bones, all bones that are similar to one of them.
//   alike  returns true if the bone `other` is similar to the selected bone `chosen`
void choose_alike(Context& context, const std::function<bool(const Armature&, int chosen, int other)>& alike) {
  const Armature& rig = *context.document().armature;
  const std::set<int> chosen = context.selection->bones;
  for (int other = 0; other < std::ssize(rig.bones); ++other)
    if (std::any_of(chosen.begin(), chosen.end(), [&](int bone) { return alike(rig, bone, other); }))
      context.selection->bones.insert(other);
}

Operator alike_operator(const char* id, const char* label, const char* description,
                        bool (*alike)(const Armature&, int chosen, int other)) {
  return {id, label, "", "Select", description, [alike](Context& c) { choose_alike(c, alike); }, needs_bone};
}

double length_of(const Bone& bone) { return glm::distance(bone.head, bone.tail); }

Operator tool_operator(const char* id, const char* label, const char* icon, const char* description, Tool tool) {
  return {id,          label,
          icon,        "Tool",
          description, [tool](Context& c) { c.interaction->tool = tool; },
          nullptr,     [tool](const Context& c) { return c.interaction->tool == tool; }};
}

}  // namespace

std::vector<Operator> select_operators() {
  return {
      {"select.pick", "Select", icon::kSelect, "Select", "Select the bone or tissue under the pointer.", pick,
       needs_volume},
      {"select.extend", "Extend selection", "", "Select",
       "Add the bone or tissue under the pointer to the selection, or remove it if it is selected.", extend,
       needs_volume},
      {"select.pick_list", "Select from list", icon::kPick, "Select",
       "Select the bone or tissue under the pointer, and list everything under the pointer.", pick_list, needs_volume},
      {"select.none", "Select nothing", "", "Select", "Deselect all bones and tissues.",
       [](Context& c) { *c.selection = {}; }},
      {"select.all", "Select all", "", "Select",
       "Select all bones in the Rig and Pose workspaces, and all tissues elsewhere. In the Rig workspace, "
       "also select all tissues if a tissue is selected.",
       choose_all, needs_volume},
      {"select.invert", "Invert selection", "", "Select",
       "Select the bones or tissues that are not selected, and deselect the others.", invert, needs_volume},
      {"select.box", "Box select", "", "Select",
       "Draw a box to add the bones in it to the selection. Shift removes them instead.",
       [](Context& c) { c.interaction->modal = begin_box_selection(c); }, needs_bones},
      {"select.circle", "Circle select", "", "Select",
       "Paint with a circle to add the bones under it to the selection. Shift removes them instead.",
       [](Context& c) { c.interaction->modal = begin_circle_selection(c); }, needs_bones},
      {"select.similar", "Select similar", "", "Select",
       "Open a menu of ways to select bones that are similar to the selected bones.",
       [](Context& c) { c.menus->open_popup = "Similar"; }, needs_bone},
      alike_operator("select.siblings", "Siblings", "Select bones with the same parent as the selected bones.",
                     [](const Armature& rig, int chosen, int other) {
                       return rig.bones[chosen].parent == rig.bones[other].parent;
                     }),
      alike_operator("select.children", "Children", "Select the children of the selected bones.",
                     [](const Armature& rig, int chosen, int other) { return rig.bones[other].parent == chosen; }),
      alike_operator("select.same_joint", "Same joint",
                     "Select bones with the same kind of joint as the selected bones: hinge, ball, fixed or free.",
                     [](const Armature& rig, int chosen, int other) {
                       return rig.bones[chosen].limits.type == rig.bones[other].limits.type;
                     }),
      alike_operator("select.same_length", "Same length",
                     "Select bones of the same length as the selected bones, within 10 %.",
                     [](const Armature& rig, int chosen, int other) {
                       return std::abs(length_of(rig.bones[chosen]) - length_of(rig.bones[other])) <=
                              0.1 * length_of(rig.bones[chosen]);
                     }),
      {"select.parent", "Select parent", "", "Select", "Select the parent of the active bone.",
       [](Context& c) { go_to_parent(c, false); }, needs_bone},
      {"select.child", "Select child", "", "Select", "Select the first child of the active bone.",
       [](Context& c) { go_to_child(c, false); }, needs_bone},
      {"select.extend_parent", "Extend to parent", "", "Select", "Add the parent of the active bone to the selection.",
       [](Context& c) { go_to_parent(c, true); }, needs_bone},
      {"select.extend_child", "Extend to child", "", "Select",
       "Add the first child of the active bone to the selection.", [](Context& c) { go_to_child(c, true); },
       needs_bone},
      {"select.chain", "Select chain", "", "Select", "Add all descendants of the selected bones to the selection.",
       choose_chain, needs_bone},
      {"select.mirror", "Select mirrored", "", "Select",
       "Select the matching bones on the body's other side in place of the selected bones.", choose_mirrored,
       needs_bone},
      tool_operator("tool.select", "Select", icon::kSelect, "Click a bone or tissue to select it.", Tool::Select),
      tool_operator("tool.cross_hair", "Cross-hair", icon::kCrossHair,
                    "Click a point to move the cross-hair and the slices to it.", Tool::CrossHair),
      tool_operator("tool.move", "Move tool", icon::kMove,
                    "Move the active bone with arrows at its end; its limb follows. The root bone moves the body.",
                    Tool::Move),
      tool_operator("tool.rotate", "Rotate tool", icon::kRotate, "Turn the active bone with rings at its joint.",
                    Tool::Rotate),
      tool_operator("tool.scale", "Scale tool", icon::kScale, "Scale the active bone with handles at its head.",
                    Tool::Scale),
      tool_operator("tool.extrude", "Extrude tool", icon::kExtrude, "Drag from a joint to add a bone.", Tool::Extrude),
      tool_operator("tool.reach", "Reach tool", icon::kReach, "Drag any joint; the bones of its limb follow.",
                    Tool::Reach),
  };
}

}  // namespace limber::editor
