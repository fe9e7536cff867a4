// SPDX-License-Identifier: AGPL-3.0-or-later
// The radius, strength or value of the brush set by the pointer, as in Blender: the ring stays where it is, the
// pointer's distance from its middle is the size. Or typed. The left button or Enter keeps it, Escape or the right
// button gives it up.
#pragma once

#include <memory>

#include "editor/context/modal_tool.h"

namespace limber::editor {

enum class BrushNumber { Radius, Strength, Value };

std::unique_ptr<Modal> begin_brush_number(Editor& editor, BrushNumber which);

// A line that is drawn with the left button, from full weight to none; R makes it a ball around its beginning. Escape
// or the right button gives it up.
std::unique_ptr<Modal> begin_gradient(Editor& editor);

}  // namespace limber::editor
