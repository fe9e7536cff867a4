// SPDX-License-Identifier: AGPL-3.0-or-later
// What the pointer is over, as far as keys and presses go by it.
#pragma once

#include <string>
#include <vector>

#include "editor/context/editor.h"

namespace limber::editor {

// The key map's contexts for the pointer's place, first to last.
std::vector<std::string> contexts(const Editor& editor);
// The view under the pointer; nullptr where a menu, dialog or another region covers it.
const ViewPlace* hovered_view(const Editor& editor);
// Over the timeline's rows, not the buttons above them.
bool over_timeline(const Editor& editor);

}  // namespace limber::editor
