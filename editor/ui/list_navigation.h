// SPDX-License-Identifier: AGPL-3.0-or-later
// Moves through lists by keyboard, and renames their rows in place. The list that was clicked last has the keyboard
// until the user presses Escape, presses a button elsewhere, or moves the pointer into a view. Until then Up, Down,
// Home, End, PageUp and PageDown move through its rows. Return acts like a click on the row, Space shows or hides it,
// F2 renames it, Left folds it and Right unfolds it.
#pragma once

#include <string>

#include "editor/ui/list_navigation.h"
#include "editor/ui/ui.h"

namespace limber::editor {

enum class ListKey { None, Moved, Activate, Toggle, Rename, Fold, Unfold };

void focus_list(Ui& ui, const std::string& list, int row);
// Handles the keys pressed in this frame: moves the list's focused row, or returns what the caller must do with this
// row. Call it once a frame, before the list draws its rows.
ListKey list_key(Ui& ui, const std::string& list, int rows);
bool has_focus(const Ui& ui, const std::string& list, int row);
// Returns true if the list that has the keyboard handles the key. The key then runs no command.
bool list_takes(const Ui& ui, const Chord& chord);

void begin_renaming(Ui& ui, const std::string& what, const std::string& name);
bool is_renaming(const Ui& ui, const std::string& what);
// Draws the text field in place of the row's name. When the user has confirmed another name, sets `name` to the new
// name and returns true.
bool rename_field(Ui& ui, const Rect& rect, std::string& name);

}  // namespace limber::editor
