// SPDX-License-Identifier: AGPL-3.0-or-later
// A modal tool that moves the eye through the 3D view, as in Blender. W, A, S and D move, E and Q go up and down, the
// mouse looks around, the wheel changes the speed; Shift is faster, Alt slower. Enter or a left click keeps the new
// view. Escape or the right mouse button restores the old view.
#pragma once

#include <memory>

#include "editor/context/modal_tool.h"

namespace limber::editor {

struct Context;

std::unique_ptr<Modal> begin_walk(Context& context);

}  // namespace limber::editor
