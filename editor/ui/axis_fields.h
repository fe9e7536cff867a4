// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <string>

#include "editor/ui/rect.h"
#include "editor/ui/section.h"
#include "editor/ui/style.h"

namespace limber::editor {

// Lays out input fields for x, y and z in one row. The fields together are wider than the single field of other rows,
// and each is marked with the colour of its axis. Returns the rectangles of the fields, in pixels.
std::array<Rect, 3> lay_axis_fields(const Look& look, Column& column, const std::string& title);

}  // namespace limber::editor
