// SPDX-License-Identifier: AGPL-3.0-or-later
// Walking through the view, as in Blender: W A S D go, E and Q rise and sink, the mouse looks round, the wheel changes
// the speed, Shift hurries and Alt slows. Enter or a click stays there, Escape or the right button returns.
#pragma once

#include <memory>

#include "editor/context/modal_tool.h"

namespace limber::editor {

std::unique_ptr<Modal> begin_walk(Editor& editor);

}  // namespace limber::editor
