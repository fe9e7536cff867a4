// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws pictures of bodies for study reports, off screen.
#pragma once

#include "core/study/picture.h"

namespace limber::editor {

// Returns a function that draws a body's picture. Throws Error if this machine has no OpenGL.
PictureMaker start_pictures();

}  // namespace limber::editor
