// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/icons.h"
#include "editor/operators/polls.h"

namespace limber::editor {

namespace {

std::string nothing_to_undo(const Editor& editor) { return editor.history.can_undo() ? "" : "Nothing to undo"; }
std::string nothing_to_redo(const Editor& editor) { return editor.history.can_redo() ? "" : "Nothing to redo"; }

}  // namespace

std::vector<Operator> edit_operators() {
  return {
      {"edit.undo", "Undo", icon::kUndo, "Edit", "Takes the last edit back.", [](Editor& e) { e.history.undo(); }, nothing_to_undo},
      {"edit.redo", "Redo", icon::kRedo, "Edit", "Does the edit again that was taken back.", [](Editor& e) { e.history.redo(); }, nothing_to_redo},
      {"edit.history", "History", icon::kHistory, "Edit", "Opens the list of edits in the sidebar.",
       [](Editor& e) {
         e.arrangement().sidebar = true;
         e.open_sections["History"] = true;
       }},
  };
}

}  // namespace limber::editor
