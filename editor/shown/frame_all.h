// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

// Puts cameras and cross-hair where the whole body is seen.
void frame_all(Editor& editor, bool animated);

}  // namespace limber::editor
