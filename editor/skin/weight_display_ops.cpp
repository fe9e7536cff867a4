// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of the weight display: switch the colouring, pick bones in the views, hide regions and lock bones.
#include "editor/context/context.h"
#include "editor/context/menu_state.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/context/views.h"
#include "editor/shown/test_pose.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/messages.h"

#include "editor/context/operator.h"
#include "editor/selection/transform_gizmo.h"
#include "editor/ui/icons.h"
#include "editor/ui/keyboard.h"

namespace limber::editor {

namespace {

using render::WeightDisplay;

std::string needs_skin_weights(const Context& context) {
  if (context.workspace() != Workspace::Skin) return "Switch to the Skin workspace first";
  if (!context.document().volume) return "Open a volume first";
  if (!context.document().armature) return "Import a rig first";
  return seen_weights(context) ? "" : "Compute the weights first";
}

std::string needs_skin_bone(const Context& context) {
  if (context.workspace() != Workspace::Skin) return "Switch to the Skin workspace first";
  return skin_bone(context) ? "" : "Import a rig first";
}

std::string needs_weights_below(const Context& context) {
  const std::string why = needs_skin_weights(context);
  if (!why.empty()) return why;
  return context.views->hover.weights.empty() ? "Put the pointer on the body" : "";
}

std::string needs_hidden(const Context& context) {
  return context.skin->hidden.empty() ? "No bone's region is hidden" : "";
}
std::string needs_locks(const Context& context) {
  const std::string why = needs_skin_bone(context);
  if (!why.empty()) return why;
  return context.document().locks && !context.document().locks->bones.empty() ? "" : "No bone is locked";
}

Operator shows(const char* id, const char* label, const char* description, std::optional<WeightDisplay> display) {
  return {id,
          label,
          "",
          "Weights",
          description,
          [display](Context& c) { c.skin->display = display; },
          needs_skin_weights,
          [display](const Context& c) { return c.skin->display == display; }};
}

// Returns the names of the selected bones. If no bone is selected, returns the name of the active bone.
std::set<std::string> chosen_names(const Context& context) {
  std::set<std::string> names;
  const auto& bones = context.document().armature->bones;
  for (const int bone : context.selection->bones)
    if (bone < std::ssize(bones)) names.insert(bones[static_cast<std::size_t>(bone)].name);
  if (names.empty()) names.insert(bones[static_cast<std::size_t>(*skin_bone(context))].name);
  return names;
}

void pick_bone(Context& context, bool added) {
  const std::string& name = context.views->hover.weights[0].bone;
  const auto bone = context.document().armature->find(name);
  if (!bone) return context.messages->warn("Pick bone", name + " is not a bone of this rig");
  // Only the bones are deselected. The selected tissues stay selected, because brushes may be limited to them.
  if (!added) context.selection->bones.clear();
  context.selection->bone = *bone;
  context.selection->bones.insert(*bone);
}

void lock_chosen(Context& context) {
  const std::set<std::string> names = chosen_names(context);
  std::set<std::string> locks = context.document().locks ? context.document().locks->bones : std::set<std::string>{};
  const bool all =
      std::all_of(names.begin(), names.end(), [&](const std::string& name) { return locks.contains(name); });
  for (const std::string& name : names) {
    if (all) locks.erase(name);
    else locks.insert(name);
  }
  set_locks(
      context,
      (all ? "Unlock " : "Lock ") + (names.size() == 1 ? *names.begin() : std::to_string(names.size()) + " bones"),
      std::move(locks));
}

void lock_all(Context& context) {
  std::set<std::string> all;
  for (const Bone& bone : context.document().armature->bones) all.insert(bone.name);
  set_locks(context, "Lock all bones", std::move(all));
}

void invert_locks(Context& context) {
  std::set<std::string> inverse;
  for (const Bone& bone : context.document().armature->bones)
    if (!is_locked(context.document(), bone.name)) inverse.insert(bone.name);
  set_locks(context, "Invert locks", std::move(inverse));
}

void search_bones(Context& context) {
  context.screen->arrangement().sidebar = true;
  context.ui->open_sections["Bones"] = context.skin->searching = context.skin->focus_search = true;
  await_field(context.ui);
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
       [](Context& c) { c.skin->contours = !c.skin->contours; }, needs_skin_weights,
       [](const Context& c) { return c.skin->contours; }},
      {"skin.display_pie", "Weight display", icon::kVisible, "Weights",
       "Open a menu at the pointer to select how weights are shown.",
       [](Context& c) { c.menus->open_popup = "Weight display"; }, needs_skin_weights},
      {"skin.pick_bone", "Pick bone", icon::kPick, "Weights",
       "Select the bone with the largest weight under the pointer.", [](Context& c) { pick_bone(c, false); },
       needs_weights_below},
      {"skin.add_bone", "Pick more bones", "", "Weights",
       "Add to the selection the bone with the largest weight under the pointer.",
       [](Context& c) { pick_bone(c, true); }, needs_weights_below},
      {"skin.find_bone", "Search bones", icon::kSearch, "Weights", "Search the list of bones by name.", search_bones,
       needs_skin_bone},
      {"skin.isolate_region", "Isolate region", icon::kVisible, "Weights",
       "Show only the tissue where the selected bones have the largest weight. Repeat to show all tissue.",
       [](Context& c) { isolate_regions(c, chosen_names(c)); }, needs_skin_weights,
       [](const Context& c) { return !c.skin->hidden.empty(); }},
      {"skin.hide_region", "Hide region", icon::kHidden, "Weights",
       "Hide the tissue where the selected bones have the largest weight.",
       [](Context& c) {
         for (const std::string& name : chosen_names(c)) hide_region(c, name, true);
       },
       needs_skin_weights},
      {"skin.reveal_regions", "Reveal regions", icon::kVisible, "Weights", "Show the regions of all bones again.",
       [](Context& c) { c.skin->hidden.clear(); }, needs_hidden},
      {"skin.lock", "Lock bone", icon::kLock, "Weights",
       "Lock the weights of the selected bones against changes, or unlock them.", lock_chosen, needs_skin_bone,
       [](const Context& c) {
         return needs_skin_bone(c).empty() &&
                is_locked(c.document(), c.document().armature->bones[static_cast<std::size_t>(*skin_bone(c))].name);
       }},
      {"skin.lock_others", "Lock all but active", icon::kLock, "Weights",
       "Lock the weights of all bones except the active one. Repeat to unlock all bones.",
       [](Context& c) { lock_all_but(c, *skin_bone(c)); }, needs_skin_bone},
      {"skin.lock_all", "Lock all bones", icon::kLock, "Weights", "Lock the weights of all bones against changes.",
       lock_all, needs_skin_bone},
      {"skin.unlock_all", "Unlock all bones", icon::kUnlocked, "Weights", "Unlock the weights of all bones.",
       [](Context& c) { set_locks(c, "Unlock all bones", {}); }, needs_locks},
      {"skin.invert_locks", "Invert locks", "", "Weights",
       "Lock the bones that are not locked, and unlock those that are.", invert_locks, needs_skin_bone},
      {"skin.lock_pie", "Locks", icon::kLock, "Weights",
       "Open a menu at the pointer with the commands that lock bones.",
       [](Context& c) { c.menus->open_popup = "Locks"; }, needs_skin_bone},
  };
}

}  // namespace limber::editor
