// SPDX-License-Identifier: AGPL-3.0-or-later
// Which text field has the keyboard. A field that was asked for gets it once the panels have been drawn a few times; keys
// that were pressed meanwhile wait in the queue, so that none of them becomes a command.
#pragma once

#include "editor/events.h"

namespace limber::editor {

struct Editor;

struct Keyboard {
  bool typed = false;    // a text field had it when the panels were drawn last
  unsigned awaited = 0;  // ImGui's id of the field that is to get it; 0: not drawn yet
  int turns = 0;         // how many times more the panels may be drawn before keys stop waiting for it

  bool waits() const { return turns > 0; }
};

// Call after something that brings a text field in this frame or the next.
void await_field(Editor& editor);
// Call between ImGui::SetKeyboardFocusHere and the field's end, with its id.
void await_field(Editor& editor, unsigned id);
// Once after the panels have been drawn.
void follow_keyboard(Editor& editor);
// Whether a text field has the keyboard now: exact between ImGui::NewFrame and the next.
bool is_typing(const Editor& editor);
// Whether something that no act of the user's brought may take the keyboard and the pointer now.
bool may_interrupt(const Editor& editor);

}  // namespace limber::editor
