// SPDX-License-Identifier: AGPL-3.0-or-later
// A linked shader program. Shaders are GLSL 3.30; `#version` is put in front here.
#pragma once

#include <string>
#include <unordered_map>

#include <glm/glm.hpp>

#include "render/gl/object.h"

namespace limber::render::gl {

class Program {
 public:
  // Throws Error with the compiler's first lines. `name` is for that message; `defines` stand before both shaders.
  Program(const std::string& name, const std::string& vertex, const std::string& fragment, const std::string& defines = "");

  void use() const;
  // Of the program in use. A uniform that the compiler dropped is ignored.
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
  // A texture unit's texture, and the sampler that reads it.
  void set_texture(const char* sampler, int unit, unsigned target, unsigned texture);

 private:
  int location(const char* uniform);

  Object<Kind::Program> program_;
  std::unordered_map<std::string, int> locations_;
};

// The vertex shader that covers the picture with one triangle (three vertices, no attributes), at the far plane.
// Gives `ndc`, -1 to 1.
extern const char* const kWholePicture;

}  // namespace limber::render::gl
