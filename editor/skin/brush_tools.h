// SPDX-License-Identifier: AGPL-3.0-or-later
// Modal operators of brushes. begin_brush_number() sets the brush's radius, strength or value as in Blender: the ring
// does not move, and the pointer's distance from the ring's centre sets the number. The user may also type it. The left
// button or Enter confirms, Escape or the right button cancels.
#pragma once

#include <memory>

#include "editor/context/modal_tool.h"

namespace limber::editor {

struct Context;

enum class BrushNumber { Radius, Strength, Value };

std::unique_ptr<Modal> begin_brush_number(Context& context, BrushNumber which);

// Begins a tool in which the user draws a line with the left button. The weight fades from full at the line's start to
// none at its end. The R key switches between fading along the line and fading in all directions from the line's start.
// Escape or the right button cancels the tool.
std::unique_ptr<Modal> begin_gradient(Context& context);

}  // namespace limber::editor
