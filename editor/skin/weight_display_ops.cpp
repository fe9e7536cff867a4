// SPDX-License-Identifier: AGPL-3.0-or-later
// How skin weights are shown and which bones they are about: displays, regions, locks.
#include "editor/skin/weight_display.h"

#include "editor/context/operator.h"
#include "editor/selection/transform_gizmo.h"
#include "editor/ui/icons.h"
#include "editor/ui/keyboard.h"

namespace limber::editor {

namespace {

using render::WeightDisplay;

std::string needs_skin_weights(const Editor& editor) {
  if (editor.workspace != Workspace::Skin) return "Works in the Skin workspace";
  if (!editor.document().volume) return "Open a volume first";
  if (!editor.document().armature) return "Import a rig first";
  return seen_weights(editor) ? "" : "Compute the weights first";
}

std::string needs_skin_bone(const Editor& editor) {
  if (editor.workspace != Workspace::Skin) return "Works in the Skin workspace";
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

// The chosen bones, or else the one that the workspace is about.
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
  if (!added) editor.selection.bones.clear();  // chosen tissues stay: brushes may be kept to them
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
            "Shows the weight of the active bone as a ramp: exact 0 grey, exact 1 white.", WeightDisplay::Active),
      shows("skin.show_dominant", "Dominant bones", "Shows each place in the colour of the bone that has most of it.",
            WeightDisplay::Dominant),
      shows("skin.show_mixed", "All influences",
            "Mixes the colours of all bones that a place follows; darker where many share it.", WeightDisplay::Mixed),
      shows("skin.show_count", "Number of influences", "Shows by colour how many bones a place follows, one to four.",
            WeightDisplay::Count),
      shows("skin.show_tissues", "Tissues", "Shows the tissues as elsewhere, without weights.", std::nullopt),
      {"skin.contours", "Contours", "", "Weights",
       "Draws lines where the active bone's weight is a quarter, a half, three quarters; else between bones' regions.",
       [](Editor& e) { e.skin->contours = !e.skin->contours; }, needs_skin_weights,
       [](const Editor& e) { return e.skin->contours; }},
      {"skin.display_pie", "Weight display", icon::kVisible, "Weights", "Lists the displays of weights at the pointer.",
       [](Editor& e) { e.open_popup = "Weight display"; }, needs_skin_weights},
      {"skin.pick_bone", "Pick bone", icon::kPick, "Weights",
       "The bone that has most of the place under the pointer becomes active.", [](Editor& e) { pick_bone(e, false); },
       needs_weights_below},
      {"skin.add_bone", "Pick bone too", "", "Weights",
       "Adds the bone that has most of the place under the pointer to the chosen ones.",
       [](Editor& e) { pick_bone(e, true); }, needs_weights_below},
      {"skin.find_bone", "Search bones", icon::kSearch, "Weights", "Finds a bone in the list of weights.", search_bones,
       needs_skin_bone},
      {"skin.isolate_region", "Isolate region", icon::kVisible, "Weights",
       "Shows only where the chosen bones have most of the weight; once more shows all.",
       [](Editor& e) { isolate_regions(e, chosen_names(e)); }, needs_skin_weights,
       [](const Editor& e) { return !e.skin->hidden.empty(); }},
      {"skin.hide_region", "Hide region", icon::kHidden, "Weights",
       "Hides where the chosen bones have most of the weight.",
       [](Editor& e) {
         for (const std::string& name : chosen_names(e)) hide_region(e, name, true);
       },
       needs_skin_weights},
      {"skin.reveal_regions", "Reveal regions", icon::kVisible, "Weights", "Shows the regions of all bones again.",
       [](Editor& e) { e.skin->hidden.clear(); }, needs_hidden},
      {"skin.lock", "Lock bone", icon::kLock, "Weights", "The chosen bones' weights cannot change, or can again.",
       lock_chosen, needs_skin_bone,
       [](const Editor& e) {
         return needs_skin_bone(e).empty() &&
                is_locked(e.document(), e.document().armature->bones[static_cast<std::size_t>(*skin_bone(e))].name);
       }},
      {"skin.lock_others", "Lock all but active", icon::kLock, "Weights",
       "The weights of the active bone alone can change; once more unlocks all.",
       [](Editor& e) { lock_all_but(e, *skin_bone(e)); }, needs_skin_bone},
      {"skin.lock_all", "Lock all bones", icon::kLock, "Weights", "No bone's weights can change.", lock_all,
       needs_skin_bone},
      {"skin.unlock_all", "Unlock all bones", icon::kUnlocked, "Weights", "Every bone's weights can change.",
       [](Editor& e) { set_locks(e, "Unlock all bones", {}); }, needs_locks},
      {"skin.invert_locks", "Invert locks", "", "Weights",
       "Locks the bones that are not locked, and unlocks those that are.", invert_locks, needs_skin_bone},
      {"skin.lock_pie", "Locks", icon::kLock, "Weights",
       "Lists what can be done with the locks of bones, at the pointer.", [](Editor& e) { e.open_popup = "Locks"; },
       needs_skin_bone},
  };
}

}  // namespace limber::editor
