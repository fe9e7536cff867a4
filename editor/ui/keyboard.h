// SPDX-License-Identifier: AGPL-3.0-or-later
// Tracks whether a text field has the keyboard. A field that requests the keyboard gets it only after the panels have
// been drawn a few times. Keys pressed in the meantime wait in the event queue, so that none of them runs a command.
#pragma once

#include "editor/ui/keyboard.h"
#include "editor/ui/ui.h"

namespace limber::editor {

// Makes pressed keys wait in the event queue for a text field that will appear in this frame or the next.
void await_field(Ui& ui);
// Makes pressed keys wait in the event queue for the text field with this ImGui id. Call it after
// ImGui::SetKeyboardFocusHere and before the field is drawn.
void await_field(Ui& ui, unsigned id);
// Updates Ui::keyboard. Call it each time after the panels have been drawn.
void follow_keyboard(Ui& ui);
// Returns true if a text field has the keyboard now. The answer holds until the next ImGui::NewFrame.
bool is_typing(const Ui& ui);

}  // namespace limber::editor
