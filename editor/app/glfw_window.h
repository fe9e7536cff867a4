// SPDX-License-Identifier: AGPL-3.0-or-later
// Opens the editor's window on the desktop, through GLFW. GLFW needs the libraries of X11, which a machine without a
// display may lack. So the window's code is in a module of its own, limber_window.so, which only open_window() loads.
#pragma once

#include <memory>

#include "editor/context/platform_window.h"

namespace limber::editor {

// Opens the window and returns it. Throws Error if the module or a library that it needs is missing, if no display can
// be reached, or if the driver has no OpenGL 3.3.
std::unique_ptr<Host> open_window(const glm::ivec2& size, const std::string& title);

}  // namespace limber::editor

// Opens the window for open_window(), which finds this function by its name in the module. The caller must delete the
// window. Throws Error if no window can be opened.
extern "C" limber::editor::Host* limber_open_window(const glm::ivec2& size, const std::string& title);
