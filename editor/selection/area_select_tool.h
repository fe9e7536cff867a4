// SPDX-License-Identifier: AGPL-3.0-or-later
// Bones chosen by an area of a view, as in Blender: in a box that is drawn with the left button, or under a circle that
// paints while the button is held and grows with the wheel. Shift takes bones out. A box ends it; Enter or the right
// button ends the circle; Escape brings back what was chosen before.
#pragma once

#include <memory>

#include "editor/context/modal_tool.h"

namespace limber::editor {

std::unique_ptr<Modal> begin_box_selection(Editor& editor);
std::unique_ptr<Modal> begin_circle_selection(Editor& editor);

}  // namespace limber::editor
