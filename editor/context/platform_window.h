// SPDX-License-Identifier: AGPL-3.0-or-later
// Where the editor lives: a window of the desktop (glfw_window.h) or a picture in memory (headless_window.h). Both have
// a current OpenGL 3.3 core context and push the user's events into one queue; the editor cannot tell which one it is
// in.
#pragma once

#include <functional>
#include <string>

#include <glm/glm.hpp>

#include "core/base/file.h"
#include "editor/input/events.h"

namespace limber::editor {

enum class Cursor { Arrow, Hand, Text, ResizeX, ResizeY, Cross, Move, Hidden };

class Host {
 public:
  virtual ~Host() = default;

  virtual glm::ivec2 size() const = 0;  // pixels of the picture
  virtual double monitor_scale() const = 0;
  virtual bool close_requested() const = 0;
  virtual void forget_close_request() = 0;

  // Returns at the first event, at wake(), or after `seconds`; 0 only gathers what has happened.
  virtual void wait(double seconds) = 0;
  virtual void wake() = 0;  // from any thread
  // Moves the pointer by so many pixels, where the desktop allows; its next move is seen there.
  virtual void shift_pointer(const glm::vec2& by) = 0;
  // Shows what `paint` draws into the bound framebuffer; a host that nobody looks at may paint later, until the next
  // present().
  virtual void present(const std::function<void()>& paint) = 0;

  virtual std::string clipboard() = 0;
  virtual void set_clipboard(const std::string& text) = 0;
  virtual void set_cursor(Cursor cursor) = 0;
  virtual void set_title(const std::string& title) = 0;
  virtual void toggle_full_screen() = 0;
  // With the program that the desktop has for it; false where there is none.
  virtual bool open_file(const Path&) { return false; }

  EventQueue events;
};

}  // namespace limber::editor
