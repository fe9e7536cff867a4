// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes an OpenGL 3.3 core context without window and display (EGL, surfaceless), for the command line and for tests.
#pragma once

#include <memory>

namespace limber::render {

// An OpenGL context. It is current on the thread that made it until the object is destroyed. Each thread may have one
// such context at a time.
class HeadlessContext {
 public:
  // Creates the context and makes it current on this thread. Throws Error when this machine has no EGL, or an OpenGL
  // older than 3.3.
  HeadlessContext();
  ~HeadlessContext();
  HeadlessContext(const HeadlessContext&) = delete;
  HeadlessContext& operator=(const HeadlessContext&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Throws Error, which names the found version, unless the current context is OpenGL 3.3 or newer.
void require_opengl_3_3();

}  // namespace limber::render
