// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator_polls.h"
#include "editor/dialogs/redo_last_operator.h"
#include "editor/resample/results.h"
#include "editor/ui/icons.h"
#include "editor/ui/list_navigation.h"

namespace limber::editor {

namespace {

std::string nothing_to_undo(const Editor& editor) { return editor.history.can_undo() ? "" : "Nothing to undo"; }
std::string nothing_to_redo(const Editor& editor) { return editor.history.can_redo() ? "" : "Nothing to redo"; }

// Returns why the command Rename cannot run, or "" if it can. It renames the selected tissue, the selected bone or the
// shown result. A list that has the keyboard renames its focused row without this command.
std::string nothing_to_rename(const Editor& editor) {
  return editor.shown_popup == "Result" || editor.selection.tissue || needs_bone(editor).empty() || shown_result(editor)
             ? ""
             : "Select a tissue or a bone, or show a result first";
}

void rename(Editor& editor) {
  editor.arrangement().sidebar = true;
  const auto result = shown_result(editor);
  // Renames the selected bone, but only if no tissue is selected.
  if (editor.shown_popup != "Result" && !editor.selection.tissue && needs_bone(editor).empty()) {
    const std::string& name = editor.document().armature->bones[*editor.selection.bone].name;
    editor.open_sections["Outliner"] = editor.outliner.open["armature"] = true;
    return begin_renaming(editor, "outlinerbone " + name, name);
  }
  const bool of_result = result && (!editor.selection.tissue || editor.shown_popup == "Result");
  if (of_result) {
    editor.open_sections["Outliner"] = editor.outliner.open["results"] = true;
    return begin_renaming(editor, "outlinerresult " + result->name, result->name);
  }
  const Tissue* tissue = editor.document().tissues->find(*editor.selection.tissue);
  editor.open_sections["Tissues"] = true;
  editor.tissue_search.clear();
  begin_renaming(editor, "tissues" + std::to_string(tissue->label), tissue->name);
}

// Moves one step back or forward in the undo history. Then selects the bones that the step restored. If there are
// none, selects the bones that have the names of the bones selected before.
void step(Editor& editor, bool (History::*go)()) {
  const std::shared_ptr<const Armature> before = editor.document().armature;
  (editor.history.*go)();
  const std::shared_ptr<const Armature> after = editor.document().armature;
  if (!before || !after || before == after) return;
  Selection next = editor.selection;
  next.bone.reset();
  next.bones.clear();
  for (int bone = 0; bone < std::ssize(after->bones); ++bone)
    if (!before->find(after->bones[bone].name)) next.bones.insert(bone);
  if (!next.bones.empty()) next.bone = *next.bones.begin();
  else
    for (const int bone : editor.selection.bones)
      if (const auto found = bone < std::ssize(before->bones) ? after->find(before->bones[bone].name) : std::nullopt) {
        next.bones.insert(*found);
        if (editor.selection.bone == bone) next.bone = found;
      }
  if (!next.bones.empty()) editor.selection = {.bone = next.bone.value_or(*next.bones.begin()), .bones = next.bones};
  else editor.selection = std::move(next);
}

}  // namespace

std::vector<Operator> edit_operators() {
  return {
      {"edit.undo", "Undo", icon::kUndo, "Edit", "Undo the last edit.", [](Editor& e) { step(e, &History::undo); },
       nothing_to_undo},
      {"edit.redo", "Redo", icon::kRedo, "Edit", "Redo the edit that was undone last.",
       [](Editor& e) { step(e, &History::redo); }, nothing_to_redo},
      {"edit.adjust_last", "Adjust last operation", "", "Edit",
       "Repeat the last operation with other settings. The new result replaces its step in the history.",
       [](Editor& e) { e.last_operation->wanted_at_pointer = true; }, why_not_redo},
      {"edit.rename", "Rename", icon::kRename, "Edit", "Rename the selected tissue or bone, or the shown result.",
       rename, nothing_to_rename},
      {"edit.history", "History", icon::kHistory, "Edit", "Open the list of edits in the sidebar.",
       [](Editor& e) {
         e.arrangement().sidebar = true;
         e.open_sections["History"] = true;
         e.wanted_section = "History";
       }},
  };
}

}  // namespace limber::editor
