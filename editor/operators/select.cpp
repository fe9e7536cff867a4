// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>

#include "core/rig/mirror.h"
#include "editor/dispatch.h"
#include "editor/gizmo.h"
#include "editor/handling.h"
#include "editor/icons.h"
#include "editor/operators/polls.h"
#include "editor/results.h"
#include "editor/tissues.h"
#include "editor/wipe.h"

namespace limber::editor {

namespace {

std::optional<int> bone_here(const Editor& editor) {
  const Rect* place = editor.layout.place_of(ViewId::Body);
  if (!editor.document().armature || editor.views->hover.view != ViewId::Body || !place) return std::nullopt;
  return body_at_pointer(editor, {ViewId::Body, *place}).pick_bone(glm::ivec2(editor.input.pointer - place->low));
}

void pick(Editor& editor) {
  if (editor.tool == Tool::CrossHair) return run(editor, "view.place_cross_hair");
  editor.handling->part = Handling::Part::Whole;
  if (pick_bone_part(editor)) return;
  if (const auto bone = bone_here(editor)) {
    editor.selection = {};
    editor.selection.bone = bone;
    editor.selection.bones = {*bone};
    return;
  }
  const Hover& hover = editor.views->hover;
  if (hover.inside) select_tissue(editor, hover.label, false);
  else editor.selection = {};
}

void extend(Editor& editor) {
  editor.handling->part = Handling::Part::Whole;
  if (const auto bone = bone_here(editor)) {
    // The active one pressed again is given up.
    if (editor.selection.bone == bone) {
      editor.selection.bones.erase(*bone);
      editor.selection.bone = editor.selection.bones.empty() ? std::nullopt : std::optional(*editor.selection.bones.begin());
    } else {
      editor.selection.bone = bone;
      editor.selection.bones.insert(*bone);
    }
    return;
  }
  if (editor.views->hover.inside) select_tissue(editor, editor.views->hover.label, true);
}

// Every visible tissue along the line of sight, nearest first. In a slice only the one under the pointer.
std::vector<Label> tissues_below(const Editor& editor) {
  const Hover& hover = editor.views->hover;
  std::vector<Label> found;
  if (!hover.inside) return found;
  const ViewPlace* under = hovered_view(editor);
  const render::Scene& scene = under ? scene_at_pointer(editor, *under) : editor.views->scene;
  const LabelVolume& volume = *scene.volume;
  const auto add = [&](Label label) {
    if (label != 0 && look_of(editor.document(), label).visible && std::find(found.begin(), found.end(), label) == found.end()) found.push_back(label);
  };
  add(hover.label);
  if (hover.view != ViewId::Body) return found;
  const Rect* place = editor.layout.place_of(ViewId::Body);
  const render::Ray ray = render::ray_through(editor.views->body.camera, editor.input.pointer - place->low, glm::ivec2(place->size()));
  const double step = std::min({volume.grid.spacing.x, volume.grid.spacing.y, volume.grid.spacing.z}) / 2;
  const double reach = glm::length(volume.grid.spacing * glm::dvec3(volume.grid.size));
  for (double t = 0; t < reach; t += step)
    if (const auto voxel = voxel_shown_at(scene, hover.point + ray.direction * t)) add(volume.at_or_air(*voxel));
  return found;
}

// The nearest one is chosen at once; a list offers what lies behind it.
void pick_list(Editor& editor) {
  pick(editor);
  editor.pick_list = tissues_below(editor);
  editor.open_pick_list = editor.pick_list.size() > 1;
}

void choose_bone(Editor& editor, int bone, bool extend) {
  if (!extend) editor.selection = {};
  editor.selection.bone = bone;
  editor.selection.bones.insert(bone);
}

void go_to_parent(Editor& editor, bool extend) {
  const int parent = editor.document().armature->bones[*editor.selection.bone].parent;
  if (parent >= 0) choose_bone(editor, parent, extend);
}

void go_to_child(Editor& editor, bool extend) {
  const std::vector<Bone>& bones = editor.document().armature->bones;
  for (int b = 0; b < std::ssize(bones); ++b)
    if (bones[b].parent == *editor.selection.bone) return choose_bone(editor, b, extend);
}

// The bone and all that hangs on it.
void choose_chain(Editor& editor) {
  const std::vector<Bone>& bones = editor.document().armature->bones;
  for (int b = *editor.selection.bone; b < std::ssize(bones); ++b)
    if (bones[b].parent >= 0 && editor.selection.bones.contains(bones[b].parent)) editor.selection.bones.insert(b);
}

void choose_mirrored(Editor& editor) {
  const std::vector<int> pairs = mirror_pairs(*editor.document().armature);
  std::set<int> bones;
  for (int bone : editor.selection.bones) bones.insert(pairs[bone]);
  editor.selection.bones = bones;
  editor.selection.bone = pairs[*editor.selection.bone];
}

void choose_all(Editor& editor) {
  const Document& document = editor.document();
  if (document.armature && (editor.workspace == Workspace::Pose || (editor.workspace == Workspace::Rig && editor.selection.tissues.empty()))) {
    for (int b = 0; b < std::ssize(document.armature->bones); ++b) editor.selection.bones.insert(b);
    if (!editor.selection.bone) editor.selection.bone = 0;
    return;
  }
  for (const Tissue& tissue : document.tissues->tissues) editor.selection.tissues.insert(tissue.label);
}

Operator tool_operator(const char* id, const char* label, const char* icon, const char* sentence, Tool tool) {
  return {id, label, icon, "Tool", sentence, [tool](Editor& e) { e.tool = tool; }, nullptr, [tool](const Editor& e) { return e.tool == tool; }};
}

}  // namespace

std::vector<Operator> select_operators() {
  return {
      {"select.pick", "Select", icon::kSelect, "Select", "Chooses the tissue under the pointer.", pick, needs_volume},
      {"select.extend", "Extend selection", "", "Select", "Adds the tissue under the pointer to the chosen ones, or takes it out.", extend, needs_volume},
      {"select.pick_list", "Select from list", icon::kPick, "Select", "Chooses the tissue under the pointer and lists what lies behind it.", pick_list, needs_volume},
      {"select.none", "Select nothing", "", "Select", "Chooses nothing.", [](Editor& e) { e.selection = {}; }},
      {"select.all", "Select all", "", "Select", "Chooses every bone in the Rig and Pose workspaces, every tissue elsewhere or where one is chosen.", choose_all, needs_volume},
      {"select.parent", "Select parent", "", "Select", "Chooses the bone that the active one hangs on.", [](Editor& e) { go_to_parent(e, false); }, needs_bone},
      {"select.child", "Select child", "", "Select", "Chooses the first bone that hangs on the active one.", [](Editor& e) { go_to_child(e, false); }, needs_bone},
      {"select.extend_parent", "Extend to parent", "", "Select", "Adds the bone that the active one hangs on.", [](Editor& e) { go_to_parent(e, true); }, needs_bone},
      {"select.extend_child", "Extend to child", "", "Select", "Adds the first bone that hangs on the active one.", [](Editor& e) { go_to_child(e, true); }, needs_bone},
      {"select.chain", "Select chain", "", "Select", "Adds everything that hangs on the chosen bones.", choose_chain, needs_bone},
      {"select.mirror", "Select mirrored", "", "Select", "Chooses the bones of the other side instead.", choose_mirrored, needs_bone},
      tool_operator("tool.select", "Select", icon::kSelect, "A click chooses the tissue under the pointer.", Tool::Select),
      tool_operator("tool.cross_hair", "Cross-hair", icon::kCrossHair, "A click moves the cross-hair, and the slices with it.", Tool::CrossHair),
      tool_operator("tool.move", "Move tool", icon::kMove, "Arrows at the active bone's end move it, and its limb follows; at the root they move the body.", Tool::Move),
      tool_operator("tool.rotate", "Rotate tool", icon::kRotate, "Rings at the active bone's joint turn it.", Tool::Rotate),
      tool_operator("tool.scale", "Scale tool", icon::kScale, "Boxes at the active bone's head lengthen and shorten it.", Tool::Scale),
      tool_operator("tool.extrude", "Extrude tool", icon::kExtrude, "A new bone grows from the joint that is dragged.", Tool::Extrude),
      tool_operator("tool.reach", "Reach tool", icon::kReach, "Any joint is dragged, and its limb follows.", Tool::Reach),
  };
}

}  // namespace limber::editor
