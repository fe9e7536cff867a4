// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <string>

#include "editor/ui/rect.h"
#include "editor/ui/section.h"
#include "editor/ui/style.h"

namespace limber::editor {

// Lays out fields for x, y and z in one row, wider than the single field of other rows, and marks them by the colours
// of the axes. Returns the rectangles of the fields, in pixels.
std::array<Rect, 3> lay_axis_fields(const Look& look, Column& column, const std::string& title);

}  // namespace limber::editor
