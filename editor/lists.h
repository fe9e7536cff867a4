// SPDX-License-Identifier: AGPL-3.0-or-later
// Lists by keyboard. The list that was clicked last has the keyboard until Escape, a press elsewhere, or the pointer's way
// through a view: then arrows, Home, End, PageUp and PageDown move through its rows, Return does what a click does, Space
// shows or hides, F2 renames, Left and Right fold. A row can be renamed in its place.
#pragma once

#include <string>

#include "editor/keys.h"
#include "editor/rect.h"

namespace limber::editor {

struct Editor;

struct ListFocus {
  std::string list;     // empty: none has it
  int row = 0;
  bool reveal = false;  // bring the row into sight
};

enum class ListKey { None, Moved, Activate, Toggle, Rename, Fold, Unfold };

void focus_list(Editor& editor, const std::string& list, int row);
// Once a frame, before the list draws its rows: what a key asks of the row that has the focus.
ListKey list_key(Editor& editor, const std::string& list, int rows);
bool has_focus(const Editor& editor, const std::string& list, int row);
// Whether the focused list has a use for the key, so that it is no command.
bool list_takes(const Editor& editor, const Chord& chord);

// The thing that is being renamed, under a name that no other has.
struct Renaming {
  std::string what, text;
  bool shown = false;  // its field stands
};
void begin_renaming(Editor& editor, const std::string& what, const std::string& name);
bool is_renaming(const Editor& editor, const std::string& what);
// The field in place of the name. True when another name was accepted: it is in `name`.
bool rename_field(Editor& editor, const Rect& rect, std::string& name);

}  // namespace limber::editor
