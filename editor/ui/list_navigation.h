// SPDX-License-Identifier: AGPL-3.0-or-later
// Lists by keyboard. The list that was clicked last has the keyboard until Escape, a press elsewhere, or the pointer's
// way through a view: then arrows, Home, End, PageUp and PageDown move through its rows, Return does what a click does,
// Space shows or hides, F2 renames, Left and Right fold. A row can be renamed in its place.
#pragma once

#include <string>

#include "editor/ui/list_navigation.h"
#include "editor/ui/ui.h"

namespace limber::editor {

enum class ListKey { None, Moved, Activate, Toggle, Rename, Fold, Unfold };

void focus_list(Ui& ui, const std::string& list, int row);
// Once a frame, before the list draws its rows: what a key asks of the row that has the focus.
ListKey list_key(Ui& ui, const std::string& list, int rows);
bool has_focus(const Ui& ui, const std::string& list, int row);
// Whether the focused list has a use for the key, so that it is no command.
bool list_takes(const Ui& ui, const Chord& chord);

void begin_renaming(Ui& ui, const std::string& what, const std::string& name);
bool is_renaming(const Ui& ui, const std::string& what);
// The field in place of the name. True when another name was accepted: it is in `name`.
bool rename_field(Ui& ui, const Rect& rect, std::string& name);

}  // namespace limber::editor
