// SPDX-License-Identifier: AGPL-3.0-or-later
// From events to operators: a drag under way first, then a focused text field, then the key map's contexts: the area
// under the pointer, the workspace, selection, view, global. A press of a button that could become a drag waits until
// it is moved by 4 pixels; released before, and within 300 ms, it is a click.
#pragma once

#include <vector>

#include "editor/context/editor.h"

namespace limber::editor {

// Between ImGui::NewFrame and the panels. `before` is the input state before these events.
void dispatch(Editor& editor, const std::vector<Event>& events, InputState before);
// Whether something that no act of the user's brought may take the keyboard and the pointer now.
bool may_interrupt(const Editor& editor);

}  // namespace limber::editor
