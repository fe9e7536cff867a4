// SPDX-License-Identifier: AGPL-3.0-or-later
// OpenGL objects as move-only values. An object's context must be current when the object is made and when it is
// destroyed.
#pragma once

#include <utility>

namespace limber::render::gl {

enum class Kind { Texture, Buffer, VertexArray, Framebuffer, Program };

// Owns one OpenGL object of kind `kind`. The owner is empty (name 0) until an object is created.
template <Kind kind>
class Object {
 public:
  Object() = default;
  static Object create();
  // Returns the owner of an OpenGL object that was made elsewhere. The owner deletes this object.
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

// Returns the number of existing OpenGL objects of all kinds: zero when all views and renderers are destroyed.
int live_objects();

// Throws Error if OpenGL has reported an error since the last call.
//   where  what was done, for the message
void check_gl(const char* where);

}  // namespace limber::render::gl
