// SPDX-License-Identifier: AGPL-3.0-or-later
// The files of render/shaders, which are part of the program.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace limber::render::gl {

struct ShaderFile {
  std::string_view name;  // "march.frag"
  std::string_view text;
};
// All of them, by name. Made by the build (render/gl/embed_shaders.cmake).
const std::vector<ShaderFile>& shader_files();

// What the driver compiles: the version of GLSL, `defines`, and the text of the file, in which each line `#include
// "other.glsl"` is replaced by that file's text. Throws std::logic_error when there is no such file.
std::string shader_source(std::string_view file, const std::string& defines = "");

}  // namespace limber::render::gl
