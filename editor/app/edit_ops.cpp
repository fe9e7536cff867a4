// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/history.h"
#include "editor/context/context.h"
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/outliner_state.h"
#include "editor/context/screen.h"
#include "editor/dialogs/redo_last_operator.h"
#include "editor/resample/results.h"
#include "editor/ui/icons.h"
#include "editor/ui/list_navigation.h"

namespace limber::editor {

namespace {

std::string nothing_to_undo(const Context& context) { return context.history->can_undo() ? "" : "Nothing to undo"; }
std::string nothing_to_redo(const Context& context) { return context.history->can_redo() ? "" : "Nothing to redo"; }

// Returns why the command Rename cannot run, or "" if it can. The command renames the selected tissue, the selected
// bone or the shown result. A list that has the keyboard focus renames its focused row itself, without this command.
std::string nothing_to_rename(const Context& context) {
  return context.menus->shown_popup == "Result" || context.selection->tissue || needs_bone(context).empty() ||
                 shown_result(context)
             ? ""
             : "Select a tissue or a bone, or show a result first";
}

void rename(Context& context) {
  context.screen->arrangement().sidebar = true;
  const auto result = shown_result(context);
  // Renames the selected bone, but only if no tissue is selected.
  if (context.menus->shown_popup != "Result" && !context.selection->tissue && needs_bone(context).empty()) {
    const std::string& name = context.document().armature->bones[*context.selection->bone].name;
    context.ui->open_sections["Outliner"] = context.outliner->open["armature"] = true;
    return begin_renaming(context.ui, "outlinerbone " + name, name);
  }
  const bool of_result = result && (!context.selection->tissue || context.menus->shown_popup == "Result");
  if (of_result) {
    context.ui->open_sections["Outliner"] = context.outliner->open["results"] = true;
    return begin_renaming(context.ui, "outlinerresult " + result->name, result->name);
  }
  const Tissue* tissue = context.document().tissues->find(*context.selection->tissue);
  context.ui->open_sections["Tissues"] = true;
  context.outliner->tissue_search.clear();
  begin_renaming(context.ui, "tissues" + std::to_string(tissue->label), tissue->name);
}

// Moves one step back or forward in the undo history. Then selects the bones that this step has added to the rig. If it
// has added none, selects the bones that have the names of the previously selected bones.
void step(Context& context, bool (History::*go)()) {
  const std::shared_ptr<const Armature> before = context.document().armature;
  ((*context.history).*go)();
  const std::shared_ptr<const Armature> after = context.document().armature;
  if (!before || !after || before == after) return;
  Selection next = context.selection;
  next.bone.reset();
  next.bones.clear();
  for (int bone = 0; bone < std::ssize(after->bones); ++bone)
    if (!before->find(after->bones[bone].name)) next.bones.insert(bone);
  if (!next.bones.empty()) next.bone = *next.bones.begin();
  else
    for (const int bone : context.selection->bones)
      if (const auto found = bone < std::ssize(before->bones) ? after->find(before->bones[bone].name) : std::nullopt) {
        next.bones.insert(*found);
        if (context.selection->bone == bone) next.bone = found;
      }
  if (!next.bones.empty()) *context.selection = {.bone = next.bone.value_or(*next.bones.begin()), .bones = next.bones};
  else *context.selection = std::move(next);
}

}  // namespace

std::vector<Operator> edit_operators() {
  return {
      {"edit.undo", "Undo", icon::kUndo, "Edit", "Undo the last edit.", [](Context& c) { step(c, &History::undo); },
       nothing_to_undo},
      {"edit.redo", "Redo", icon::kRedo, "Edit", "Redo the edit that was undone last.",
       [](Context& c) { step(c, &History::redo); }, nothing_to_redo},
      {"edit.adjust_last", "Adjust last operation", "", "Edit",
       "Open the settings of the last operation. A changed setting undoes the operation and runs it again.",
       [](Context& c) { c.last_operation->wanted_at_pointer = true; }, why_not_redo},
      {"edit.rename", "Rename", icon::kRename, "Edit", "Rename the selected tissue or bone, or the shown result.",
       rename, nothing_to_rename},
      {"edit.history", "History", icon::kHistory, "Edit", "Open the list of edits in the sidebar.",
       [](Context& c) {
         c.screen->arrangement().sidebar = true;
         c.ui->open_sections["History"] = true;
         c.ui->wanted_section = "History";
       }},
  };
}

}  // namespace limber::editor
