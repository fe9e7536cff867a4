// SPDX-License-Identifier: AGPL-3.0-or-later
// Two modal tools that select the bones in an area of a view, as in Blender. Box select: the user draws a box with the
// left button, which ends the tool. Circle select: a circle selects while the left button is held; the wheel changes
// its size, and Enter or the right button ends the tool. In both, Shift removes bones from the selection, and Escape
// restores the earlier selection.
#pragma once

#include <memory>

#include "editor/context/modal_tool.h"

namespace limber::editor {

struct Context;

std::unique_ptr<Modal> begin_box_selection(Context& context);
std::unique_ptr<Modal> begin_circle_selection(Context& context);

}  // namespace limber::editor
