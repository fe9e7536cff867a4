// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

// Moves the cameras of all views so that they show all visible tissue. If not animated, also moves the cross-hair to
// the body's middle.
void frame_all(Editor& editor, bool animated);

}  // namespace limber::editor
