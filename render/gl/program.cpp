// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/gl/program.h"

#include <vector>

#include <epoxy/gl.h>
#include <glm/gtc/type_ptr.hpp>

#include "core/base/error.h"
#include "render/gl/shader_source.h"

namespace limber::render::gl {

namespace {

// Owns a shader object, which is needed only until the program is linked.
class Shader {
 public:
  explicit Shader(GLenum type) : name_(glCreateShader(type)) {}
  ~Shader() { glDeleteShader(name_); }
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
  GLuint name() const { return name_; }

 private:
  GLuint name_;
};

[[noreturn]] void refuse(const std::string& name, const char* step, std::vector<char> log) {
  log.push_back('\0');
  std::string text(log.data());
  if (text.size() > 400) text.resize(400);
  throw Error("the graphics driver cannot " + std::string(step) + " a shader", name + " (" + text + ")",
              "update the graphics driver");
}

void compile(const Shader& shader, const std::string& name, const std::string& source) {
  const char* text = source.c_str();
  glShaderSource(shader.name(), 1, &text, nullptr);
  glCompileShader(shader.name());
  GLint done = 0, length = 0;
  glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &done);
  if (done) return;
  glGetShaderiv(shader.name(), GL_INFO_LOG_LENGTH, &length);
  std::vector<char> log(static_cast<size_t>(length) + 1);
  glGetShaderInfoLog(shader.name(), length, nullptr, log.data());
  refuse(name, "compile", std::move(log));
}

}  // namespace

std::string define(const std::string& name, const std::string& value) { return "#define " + name + " " + value + "\n"; }
std::string define(const std::string& name, int value) { return define(name, std::to_string(value)); }
std::string define(const std::string& name) { return define(name, ""); }

Program::Program(const std::string& vertex_file, const std::string& fragment_file, const std::string& defines)
    : program_(Object<Kind::Program>::create()) {
  const Shader vertex_shader(GL_VERTEX_SHADER), fragment_shader(GL_FRAGMENT_SHADER);
  compile(vertex_shader, vertex_file, shader_source(vertex_file, defines));
  compile(fragment_shader, fragment_file, shader_source(fragment_file, defines));
  glAttachShader(program_.name(), vertex_shader.name());
  glAttachShader(program_.name(), fragment_shader.name());
  glLinkProgram(program_.name());
  glDetachShader(program_.name(), vertex_shader.name());
  glDetachShader(program_.name(), fragment_shader.name());
  GLint done = 0, length = 0;
  glGetProgramiv(program_.name(), GL_LINK_STATUS, &done);
  if (done) return;
  glGetProgramiv(program_.name(), GL_INFO_LOG_LENGTH, &length);
  std::vector<char> log(static_cast<size_t>(length) + 1);
  glGetProgramInfoLog(program_.name(), length, nullptr, log.data());
  refuse(vertex_file + " and " + fragment_file, "link", std::move(log));
}

void Program::use() const { glUseProgram(program_.name()); }

int Program::location(const char* uniform) {
  const auto [found, is_new] = locations_.try_emplace(uniform, -1);
  if (is_new) found->second = glGetUniformLocation(program_.name(), uniform);
  return found->second;
}

void Program::set(const char* uniform, int value) { glUniform1i(location(uniform), value); }
void Program::set(const char* uniform, unsigned value) { glUniform1ui(location(uniform), value); }
void Program::set(const char* uniform, float value) { glUniform1f(location(uniform), value); }
void Program::set(const char* uniform, const glm::ivec2& value) {
  glUniform2iv(location(uniform), 1, glm::value_ptr(value));
}
void Program::set(const char* uniform, const glm::ivec3& value) {
  glUniform3iv(location(uniform), 1, glm::value_ptr(value));
}
void Program::set(const char* uniform, const glm::vec2& value) {
  glUniform2fv(location(uniform), 1, glm::value_ptr(value));
}
void Program::set(const char* uniform, const glm::vec3& value) {
  glUniform3fv(location(uniform), 1, glm::value_ptr(value));
}
void Program::set(const char* uniform, const glm::vec4& value) {
  glUniform4fv(location(uniform), 1, glm::value_ptr(value));
}
void Program::set(const char* uniform, const glm::mat3& value) {
  glUniformMatrix3fv(location(uniform), 1, GL_FALSE, glm::value_ptr(value));
}
void Program::set(const char* uniform, const glm::mat4& value) {
  glUniformMatrix4fv(location(uniform), 1, GL_FALSE, glm::value_ptr(value));
}

void Program::set_texture(const char* sampler, int unit, unsigned target, unsigned texture) {
  glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
  glBindTexture(target, texture);
  set(sampler, unit);
}

}  // namespace limber::render::gl
