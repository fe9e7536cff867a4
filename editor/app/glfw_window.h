// SPDX-License-Identifier: AGPL-3.0-or-later
// Opens the editor's window on the desktop, through GLFW.
#pragma once

#include <memory>

#include "editor/context/platform_window.h"

namespace limber::editor {

// Opens the window and returns it. Throws Error if no display can be reached, or if the driver has no OpenGL 3.3.
std::unique_ptr<Host> open_window(const glm::ivec2& size, const std::string& title);

}  // namespace limber::editor
