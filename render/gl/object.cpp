// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/gl/object.h"

#include <atomic>
#include <string>

#include <epoxy/gl.h>

#include "core/base/error.h"

namespace limber::render::gl {

namespace {

std::atomic<int> live = 0;

const char* text_of(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM: return "an invalid enumerant";
    case GL_INVALID_VALUE: return "an invalid value";
    case GL_INVALID_OPERATION: return "an invalid operation";
    case GL_INVALID_FRAMEBUFFER_OPERATION: return "an incomplete framebuffer";
    case GL_OUT_OF_MEMORY: return "no memory left";
    default: return "an unknown error";
  }
}

}  // namespace

template <Kind kind>
Object<kind> Object<kind>::create() {
  GLuint name = 0;
  if constexpr (kind == Kind::Texture) glGenTextures(1, &name);
  if constexpr (kind == Kind::Buffer) glGenBuffers(1, &name);
  if constexpr (kind == Kind::VertexArray) glGenVertexArrays(1, &name);
  if constexpr (kind == Kind::Framebuffer) glGenFramebuffers(1, &name);
  if constexpr (kind == Kind::Program) name = glCreateProgram();
  return adopt(name);
}

template <Kind kind>
Object<kind> Object<kind>::adopt(unsigned name) {
  Object object;
  object.name_ = name;
  if (name != 0) ++live;
  return object;
}

template <Kind kind>
void Object<kind>::reset() {
  if (name_ == 0) return;
  if constexpr (kind == Kind::Texture) glDeleteTextures(1, &name_);
  if constexpr (kind == Kind::Buffer) glDeleteBuffers(1, &name_);
  if constexpr (kind == Kind::VertexArray) glDeleteVertexArrays(1, &name_);
  if constexpr (kind == Kind::Framebuffer) glDeleteFramebuffers(1, &name_);
  if constexpr (kind == Kind::Program) glDeleteProgram(name_);
  name_ = 0;
  --live;
}

template class Object<Kind::Texture>;
template class Object<Kind::Buffer>;
template class Object<Kind::VertexArray>;
template class Object<Kind::Framebuffer>;
template class Object<Kind::Program>;

int live_objects() { return live; }

void check_gl(const char* where) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  while (glGetError() != GL_NO_ERROR) {
  }
  throw Error(
      std::string("the graphics driver reports ") + text_of(error), where,
      error == GL_OUT_OF_MEMORY ? "close other programs, or use a coarser volume" : "update the graphics driver");
}

}  // namespace limber::render::gl
