// SPDX-License-Identifier: AGPL-3.0-or-later
// The outline of what triangles cover of a picture: they are filled into cells, the border of the filled ones is
// followed around and smoothed.
#pragma once

#include <vector>

#include "editor/ui/rect.h"

namespace limber::editor {

// Closed lines in pixels, with what is covered on the left where y points up; holes the other way.
//   points   pixels; a NaN is behind the eye, and its triangles are left out
//   corners  of triangles
//   picture  beyond which nothing counts; what is cut off by its border is closed along it
//   cell     pixels
std::vector<std::vector<glm::vec2>> silhouette(const std::vector<glm::vec2>& points,
                                               const std::vector<glm::u32vec3>& corners, const Rect& picture,
                                               float cell);

}  // namespace limber::editor
