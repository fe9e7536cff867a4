// SPDX-License-Identifier: AGPL-3.0-or-later
// Bodies for the reports of studies, drawn without a display.
#pragma once

#include "core/study/picture.h"

namespace limber::editor {

// Throws Error where this machine has no OpenGL.
PictureMaker start_pictures();

}  // namespace limber::editor
