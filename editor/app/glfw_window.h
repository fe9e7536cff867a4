// SPDX-License-Identifier: AGPL-3.0-or-later
// A window of the desktop, through GLFW.
#pragma once

#include <memory>

#include "editor/context/platform_window.h"

namespace limber::editor {

// Throws Error where no display can be reached, or where the driver has no OpenGL 3.3.
std::unique_ptr<Host> open_window(const glm::ivec2& size, const std::string& title);

}  // namespace limber::editor
