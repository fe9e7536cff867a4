// SPDX-License-Identifier: AGPL-3.0-or-later
// Which text field has the keyboard. A field that was asked for gets it once the panels have been drawn a few times;
// keys that were pressed meanwhile wait in the queue, so that none of them becomes a command.
#pragma once

#include "editor/ui/keyboard.h"
#include "editor/ui/ui.h"

namespace limber::editor {

// Call after something that brings a text field in this frame or the next.
void await_field(Ui& ui);
// Call between ImGui::SetKeyboardFocusHere and the field's end, with its id.
void await_field(Ui& ui, unsigned id);
// Once after the panels have been drawn.
void follow_keyboard(Ui& ui);
// Whether a text field has the keyboard now: exact between ImGui::NewFrame and the next.
bool is_typing(const Ui& ui);

}  // namespace limber::editor
