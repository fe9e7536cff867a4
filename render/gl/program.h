// SPDX-License-Identifier: AGPL-3.0-or-later
// A linked shader program, compiled from files of render/shaders.
#pragma once

#include <string>
#include <unordered_map>

#include <glm/glm.hpp>

#include "render/gl/object.h"

namespace limber::render::gl {

// These functions return a line of GLSL that defines a preprocessor name.
std::string define(const std::string& name);
std::string define(const std::string& name, int value);
std::string define(const std::string& name, const std::string& value);

class Program {
 public:
  // Compiles a vertex and a fragment shader from two files of render/shaders (such as "march.frag"), and links them.
  // The lines of `defines`, made by define(), come before the text of each file. Throws Error with the first lines of
  // the compiler's messages.
  Program(const std::string& vertex_file, const std::string& fragment_file, const std::string& defines = "");

  void use() const;
  // Sets a uniform of this program, which must be in use. A uniform that the compiler removed is ignored.
  void set(const char* uniform, int value);
  void set(const char* uniform, unsigned value);
  void set(const char* uniform, float value);
  void set(const char* uniform, const glm::ivec2& value);
  void set(const char* uniform, const glm::ivec3& value);
  void set(const char* uniform, const glm::vec2& value);
  void set(const char* uniform, const glm::vec3& value);
  void set(const char* uniform, const glm::vec4& value);
  void set(const char* uniform, const glm::mat3& value);
  void set(const char* uniform, const glm::mat4& value);
  // Binds a texture to a texture unit, and makes the sampler read this unit.
  void set_texture(const char* sampler, int unit, unsigned target, unsigned texture);

 private:
  int location(const char* uniform);

  Object<Kind::Program> program_;
  std::unordered_map<std::string, int> locations_;
};

// File of the vertex shader that covers the whole picture with one triangle (three vertices, no attributes).
inline const char* const kWholePicture = "whole_picture.vert";

}  // namespace limber::render::gl
