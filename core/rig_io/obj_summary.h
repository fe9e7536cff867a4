// SPDX-License-Identifier: AGPL-3.0-or-later
// What a Wavefront OBJ file holds, counted.
#pragma once

#include <cstdint>
#include <string>

#include <glm/glm.hpp>

#include "core/base/file.h"

namespace limber {

struct ObjSummary {
  std::int64_t vertices = 0, faces = 0, groups = 0;  // `v`, `f`, and `g` or `o` lines
  glm::dvec3 lower{0}, upper{0};                     // the vertices' box
};

// Throws Error with the line for a vertex without three finite numbers, a face of fewer than three corners or with a
// corner that is no vertex, or a file without vertices.
ObjSummary read_obj_summary(const Path& path);
ObjSummary parse_obj_summary(const std::string& text, const std::string& where);

}  // namespace limber
