// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs the operators that the user's input events are bound to. An event goes first to a running drag, then to a
// focused text field, then to the contexts of the key map: the area under the pointer, the workspace, selection, view,
// global. A button press becomes a drag when the pointer moves by 4 px. If the button is released before that, and
// within 300 ms, the press is a click.
#pragma once

#include <vector>

#include "editor/input/events.h"

namespace limber::editor {

struct Context;

// Handles the events of a frame. Call it after ImGui::NewFrame and before the panels are drawn. `before` is the input
// state before these events.
void dispatch(Context& context, const std::vector<Event>& events, InputState before);
// Returns true if a dialog or message that the user did not ask for may take the keyboard and the pointer now.
bool may_interrupt(const Context& context);

}  // namespace limber::editor
