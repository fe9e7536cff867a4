// SPDX-License-Identifier: AGPL-3.0-or-later
// The window in which the editor runs: a window of the desktop (glfw_window.h) or a picture in memory
// (headless_window.h). Each has a current OpenGL 3.3 core context and pushes the user's events into a queue, so that
// the editor works the same in either window.
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

  virtual glm::ivec2 size() const = 0;  // the window's inner size, pixels
  virtual double monitor_scale() const = 0;
  virtual bool close_requested() const = 0;
  virtual void forget_close_request() = 0;

  // Waits until an event arrives, wake() is called, or `seconds` have passed. If `seconds` is 0, collects the pending
  // events and returns at once.
  virtual void wait(double seconds) = 0;
  virtual void wake() = 0;  // ends wait(); may be called from any thread
  // Moves the pointer by `by` pixels, if the desktop allows it. The next PointerMoved event starts from the new
  // position.
  virtual void shift_pointer(const glm::vec2& by) = 0;
  // Calls `paint`, which draws into the bound framebuffer, and shows the picture in the window. A window in memory may
  // call `paint` later, but before the next present().
  virtual void present(const std::function<void()>& paint) = 0;

  virtual std::string clipboard() = 0;
  virtual void set_clipboard(const std::string& text) = 0;
  virtual void set_cursor(Cursor cursor) = 0;
  virtual void set_title(const std::string& title) = 0;
  virtual void toggle_full_screen() = 0;
  // Opens a file in the program that the desktop uses for files of this kind. Returns false if there is no such
  // program.
  virtual bool open_file(const Path&) { return false; }

  EventQueue events;
};

}  // namespace limber::editor
