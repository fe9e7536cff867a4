// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of the weight display: switch the colouring, pick bones in the views, hide regions and lock bones.
#include "editor/skin/weight_display.h"

#include "editor/context/operator.h"
#include "editor/selection/transform_gizmo.h"
#include "editor/ui/icons.h"
#include "editor/ui/keyboard.h"

namespace limber::editor {

namespace {

using render::WeightDisplay;

std::string needs_skin_weights(const Editor& editor) {
  if (editor.workspace != Workspace::Skin) return "Switch to the Skin workspace first";
  if (!editor.document().volume) return "Open a volume first";
  if (!editor.document().armature) return "Import a rig first";
  return seen_weights(editor) ? "" : "Compute the weights first";
}

std::string needs_skin_bone(const Editor& editor) {
  if (editor.workspace != Workspace::Skin) return "Switch to the Skin workspace first";
  return skin_bone(editor) ? "" : "Import a rig first";
}

std::string needs_weights_below(const Editor& editor) {
  const std::string why = needs_skin_weights(editor);
  if (!why.empty()) return why;
  return editor.views->hover.weights.empty() ? "Point at the body" : "";
}

std::string needs_hidden(const Editor& editor) {
  return editor.skin->hidden.empty() ? "No bone's region is hidden" : "";
}
std::string needs_locks(const Editor& editor) {
  const std::string why = needs_skin_bone(editor);
  if (!why.empty()) return why;
  return editor.document().locks && !editor.document().locks->bones.empty() ? "" : "No bone is locked";
}

Operator shows(const char* id, const char* label, const char* description, std::optional<WeightDisplay> display) {
  return {id,
          label,
          "",
          "Weights",
          description,
          [display](Editor& e) { e.skin->display = display; },
          needs_skin_weights,
          [display](const Editor& e) { return e.skin->display == display; }};
}

// Returns the names of the selected bones. If no bone is selected, returns the name of the active bone.
std::set<std::string> chosen_names(const Editor& editor) {
  std::set<std::string> names;
  const auto& bones = editor.document().armature->bones;
  for (const int bone : editor.selection.bones)
    if (bone < std::ssize(bones)) names.insert(bones[static_cast<std::size_t>(bone)].name);
  if (names.empty()) names.insert(bones[static_cast<std::size_t>(*skin_bone(editor))].name);
  return names;
}

void pick_bone(Editor& editor, bool added) {
  const std::string& name = editor.views->hover.weights[0].bone;
  const auto bone = editor.document().armature->find(name);
  if (!bone) return editor.messages.warn("Pick bone", name + " is not a bone of this rig");
  // Only the bones are deselected. The selected tissues stay selected, because brushes may be limited to them.
  if (!added) editor.selection.bones.clear();
  editor.selection.bone = *bone;
  editor.selection.bones.insert(*bone);
}

void lock_chosen(Editor& editor) {
  const std::set<std::string> names = chosen_names(editor);
  std::set<std::string> locks = editor.document().locks ? editor.document().locks->bones : std::set<std::string>{};
  const bool all =
      std::all_of(names.begin(), names.end(), [&](const std::string& name) { return locks.contains(name); });
  for (const std::string& name : names) {
    if (all) locks.erase(name);
    else locks.insert(name);
  }
  set_locks(
      editor,
      (all ? "Unlock " : "Lock ") + (names.size() == 1 ? *names.begin() : std::to_string(names.size()) + " bones"),
      std::move(locks));
}

void lock_all(Editor& editor) {
  std::set<std::string> all;
  for (const Bone& bone : editor.document().armature->bones) all.insert(bone.name);
  set_locks(editor, "Lock all bones", std::move(all));
}

void invert_locks(Editor& editor) {
  std::set<std::string> inverse;
  for (const Bone& bone : editor.document().armature->bones)
    if (!is_locked(editor.document(), bone.name)) inverse.insert(bone.name);
  set_locks(editor, "Invert locks", std::move(inverse));
}

void search_bones(Editor& editor) {
  editor.arrangement().sidebar = true;
  editor.open_sections["Bones"] = editor.skin->searching = editor.skin->focus_search = true;
  await_field(editor);
}

}  // namespace

std::vector<Operator> skin_display_operators() {
  return {
      shows("skin.show_active", "Active bone",
            "Show the active bone's weight as a colour ramp: exactly 0 is grey, exactly 1 is white.",
            WeightDisplay::Active),
      shows("skin.show_dominant", "Dominant bones", "Colour each voxel by the bone with the largest weight.",
            WeightDisplay::Dominant),
      shows("skin.show_mixed", "All influences",
            "Mix the colours of all bones that a voxel follows. Voxels that many bones share are darker.",
            WeightDisplay::Mixed),
      shows("skin.show_count", "Number of influences",
            "Colour each voxel by the number of bones that it follows, one to four.", WeightDisplay::Count),
      shows("skin.show_tissues", "Tissues", "Show the tissue colours instead of weights.", std::nullopt),
      {"skin.contours", "Contours", "", "Weights",
       "Draw lines where the active bone's weight is 0.25, 0.5 and 0.75, or between the regions of bones.",
       [](Editor& e) { e.skin->contours = !e.skin->contours; }, needs_skin_weights,
       [](const Editor& e) { return e.skin->contours; }},
      {"skin.display_pie", "Weight display", icon::kVisible, "Weights",
       "Open a menu at the pointer to select how weights are shown.",
       [](Editor& e) { e.open_popup = "Weight display"; }, needs_skin_weights},
      {"skin.pick_bone", "Pick bone", icon::kPick, "Weights",
       "Select the bone with the largest weight under the pointer.", [](Editor& e) { pick_bone(e, false); },
       needs_weights_below},
      {"skin.add_bone", "Pick more bones", "", "Weights",
       "Add to the selection the bone with the largest weight under the pointer.",
       [](Editor& e) { pick_bone(e, true); }, needs_weights_below},
      {"skin.find_bone", "Search bones", icon::kSearch, "Weights", "Search the list of bones by name.", search_bones,
       needs_skin_bone},
      {"skin.isolate_region", "Isolate region", icon::kVisible, "Weights",
       "Show only the tissue where the selected bones have the largest weight. Repeat to show all tissue.",
       [](Editor& e) { isolate_regions(e, chosen_names(e)); }, needs_skin_weights,
       [](const Editor& e) { return !e.skin->hidden.empty(); }},
      {"skin.hide_region", "Hide region", icon::kHidden, "Weights",
       "Hide the tissue where the selected bones have the largest weight.",
       [](Editor& e) {
         for (const std::string& name : chosen_names(e)) hide_region(e, name, true);
       },
       needs_skin_weights},
      {"skin.reveal_regions", "Reveal regions", icon::kVisible, "Weights", "Show the regions of all bones again.",
       [](Editor& e) { e.skin->hidden.clear(); }, needs_hidden},
      {"skin.lock", "Lock bone", icon::kLock, "Weights",
       "Lock the weights of the selected bones against changes, or unlock them.", lock_chosen, needs_skin_bone,
       [](const Editor& e) {
         return needs_skin_bone(e).empty() &&
                is_locked(e.document(), e.document().armature->bones[static_cast<std::size_t>(*skin_bone(e))].name);
       }},
      {"skin.lock_others", "Lock all but active", icon::kLock, "Weights",
       "Lock the weights of all bones except the active one. Repeat to unlock all bones.",
       [](Editor& e) { lock_all_but(e, *skin_bone(e)); }, needs_skin_bone},
      {"skin.lock_all", "Lock all bones", icon::kLock, "Weights", "Lock the weights of all bones against changes.",
       lock_all, needs_skin_bone},
      {"skin.unlock_all", "Unlock all bones", icon::kUnlocked, "Weights", "Unlock the weights of all bones.",
       [](Editor& e) { set_locks(e, "Unlock all bones", {}); }, needs_locks},
      {"skin.invert_locks", "Invert locks", "", "Weights",
       "Lock the bones that are not locked, and unlock those that are.", invert_locks, needs_skin_bone},
      {"skin.lock_pie", "Locks", icon::kLock, "Weights",
       "Open a menu at the pointer with the commands that lock bones.", [](Editor& e) { e.open_popup = "Locks"; },
       needs_skin_bone},
  };
}

}  // namespace limber::editor
