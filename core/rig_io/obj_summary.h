// SPDX-License-Identifier: AGPL-3.0-or-later
// Counts the vertices, faces and groups of a Wavefront OBJ file.
#pragma once

#include <cstdint>
#include <string>

#include <glm/glm.hpp>

#include "core/base/file.h"

namespace limber {

struct ObjSummary {
  std::int64_t vertices = 0, faces = 0, groups = 0;  // number of `v` lines, `f` lines, and `g` or `o` lines
  glm::dvec3 lower{0}, upper{0};                     // bounding box of the vertices, in the file's unit
};

// Returns the counts and the bounding box. Throws Error, with the line, for a vertex without three finite numbers, for
// a face with fewer than three corners or with a corner that is not a vertex, and for a file without vertices.
ObjSummary read_obj_summary(const Path& path);
ObjSummary parse_obj_summary(const std::string& text, const std::string& where);

}  // namespace limber
