// SPDX-License-Identifier: AGPL-3.0-or-later
// OpenGL objects as move-only values: made and destroyed with the context that made them current.
#pragma once

#include <utility>

namespace limber::render::gl {

enum class Kind { Texture, Buffer, VertexArray, Framebuffer, Program };

// Owns one name of that kind; empty (0) until created.
template <Kind kind>
class Object {
 public:
  Object() = default;
  static Object create();
  // Takes over a name that was made elsewhere.
  static Object adopt(unsigned name);
  ~Object() { reset(); }
  Object(Object&& other) noexcept : name_(std::exchange(other.name_, 0u)) {}
  Object& operator=(Object&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }

  unsigned name() const { return name_; }
  explicit operator bool() const { return name_ != 0; }
  void reset();

 private:
  unsigned name_ = 0;
};

using Texture = Object<Kind::Texture>;
using Buffer = Object<Kind::Buffer>;
using VertexArray = Object<Kind::VertexArray>;
using Framebuffer = Object<Kind::Framebuffer>;

// How many objects live now, of every kind: zero when all views and renderers are gone.
int live_objects();

// Throws Error naming `where` when OpenGL has reported an error since the last call.
void check_gl(const char* where);

}  // namespace limber::render::gl
