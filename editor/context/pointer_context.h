// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds what lies under the pointer, since the meaning of keys and mouse buttons depends on it.
#pragma once

#include <string>
#include <vector>

#include "editor/context/editor.h"

namespace limber::editor {

// Returns the key map's contexts that apply at the pointer's position, in the order in which they are searched.
std::vector<std::string> contexts(const Editor& editor);
// Returns the view under the pointer; nullptr where a menu, dialog or another region covers it.
const ViewPlace* hovered_view(const Editor& editor);
// Returns whether the pointer is over the timeline's rows, not the buttons above them.
bool over_timeline(const Editor& editor);

}  // namespace limber::editor
