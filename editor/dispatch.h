// SPDX-License-Identifier: AGPL-3.0-or-later
// From events to operators: a drag under way first, then a focused text field, then the key map's contexts: the area under
// the pointer, the workspace, selection, view, global. A press of a button that could become a drag waits until it is
// moved by 4 pixels; released before, and within 300 ms, it is a click.
#pragma once

#include <string>
#include <vector>

#include "editor/editor.h"

namespace limber::editor {

// Between ImGui::NewFrame and the panels. `before` is the input state before these events.
void dispatch(Editor& editor, const std::vector<Event>& events, InputState before);
// The key map's contexts for the pointer's place, first to last.
std::vector<std::string> contexts(const Editor& editor);
// The view under the pointer; nullptr where a menu, dialog or another region covers it.
const ViewPlace* hovered_view(const Editor& editor);

}  // namespace limber::editor
