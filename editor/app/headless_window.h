// SPDX-License-Identifier: AGPL-3.0-or-later
// A window that exists only as a picture in memory, drawn through surfaceless EGL. Tests and scripts run the real
// editor in it.
#pragma once

#include <memory>

#include "editor/context/platform_window.h"
#include "render/image_io.h"

namespace limber::editor {

class Offscreen : public Host {
 public:
  virtual void resize(const glm::ivec2& size) = 0;
  // Draws the last presented frame and waits until OpenGL has finished. (A window on a desktop does this when it swaps
  // its buffers.)
  virtual void finish() = 0;
  // Draws the last presented frame and returns its picture. Frames are drawn only on request, because a script needs
  // few pictures.
  virtual render::Image picture() = 0;
  virtual glm::vec2 shifted() const = 0;  // sum of all moves of the pointer by shift_pointer(), pixels
  virtual bool full_screen() const = 0;   // true if the editor asked for full screen
};

// Makes the window in memory and returns it. Throws Error if EGL gives no OpenGL 3.3 context.
std::unique_ptr<Offscreen> open_offscreen(const glm::ivec2& size, double monitor_scale = 1);

}  // namespace limber::editor
