// SPDX-License-Identifier: AGPL-3.0-or-later
// An OpenGL 3.3 core context without window and display (EGL, surfaceless): for the command line and for tests.
#pragma once

#include <memory>

namespace limber::render {

// Current on the thread that made it while it lives. One at a time for a thread; threads may have their own.
class HeadlessContext {
 public:
  // Throws Error when this machine has no EGL, or an OpenGL older than 3.3.
  HeadlessContext();
  ~HeadlessContext();
  HeadlessContext(const HeadlessContext&) = delete;
  HeadlessContext& operator=(const HeadlessContext&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Throws Error unless the current context is OpenGL 3.3 or newer; names what it is.
void require_opengl_3_3();

}  // namespace limber::render
