// SPDX-License-Identifier: AGPL-3.0-or-later
// A window that is only a picture in memory: surfaceless EGL. Tests and scripts run the real editor in it.
#pragma once

#include <memory>

#include "editor/context/platform_window.h"
#include "render/image_io.h"

namespace limber::editor {

class Offscreen : public Host {
 public:
  virtual void resize(const glm::ivec2& size) = 0;
  // The last frame presented, painted only now: most frames of a script are looked at by nobody.
  virtual render::Image picture() = 0;
  virtual glm::vec2 shifted() const = 0;  // by how much shift_pointer() has moved the pointer, in all
  virtual bool full_screen() const = 0;   // as it would be on a desktop
};

// Throws Error where EGL gives no OpenGL 3.3 context.
std::unique_ptr<Offscreen> open_offscreen(const glm::ivec2& size, double monitor_scale = 1);

}  // namespace limber::editor
