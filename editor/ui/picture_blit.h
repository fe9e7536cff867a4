// SPDX-License-Identifier: AGPL-3.0-or-later
// Puts an opaque picture into the window by copying its pixels. A software OpenGL copies pixels several times faster
// than it draws the same picture as a textured rectangle.
#pragma once

#include "editor/ui/rect.h"

namespace limber::editor {

// Adds the picture to what ImGui's current window draws, and stretches it to the rectangle. The picture must keep its
// texture until the frame is drawn.
//   texture  RGBA8, bottom row first, without transparency
//   rect     in pixels of the window, below 65536; parts outside of ImGui's clip rectangle are not drawn
void blit_picture(unsigned texture, const Rect& rect);

}  // namespace limber::editor
