// SPDX-License-Identifier: AGPL-3.0-or-later
// Gives access to the files of render/shaders, which are embedded in the program.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace limber::render::gl {

struct ShaderFile {
  std::string_view name;  // name of the file, such as "march.frag"
  std::string_view text;
};
// Returns all shader files, sorted by name. The build generates this function (render/gl/embed_shaders.cmake).
const std::vector<ShaderFile>& shader_files();

// Returns the source that the driver compiles: the version of GLSL, `defines`, and the text of the file. Each line
// `#include "other.glsl"` is replaced by the text of that file. Throws std::logic_error when there is no such file.
std::string shader_source(std::string_view file, const std::string& defines = "");

}  // namespace limber::render::gl
