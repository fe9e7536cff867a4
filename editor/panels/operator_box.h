// SPDX-License-Identifier: AGPL-3.0-or-later
// A check box for an operator that is on or off, with its tool tip; where it cannot run it says why.
#pragma once

#include <string>
#include <string_view>

#include "editor/rect.h"

namespace limber::editor {

struct Editor;

void operator_box(Editor& editor, std::string_view id, const Rect& rect, const std::string& label);

}  // namespace limber::editor
