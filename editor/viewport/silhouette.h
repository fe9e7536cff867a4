// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the outline of the area that triangles cover in a picture. It fills the triangles into a grid of cells,
// follows the border of the filled cells, and smooths this border.
#pragma once

#include <vector>

#include "editor/ui/rect.h"

namespace limber::editor {

// Returns the outlines as closed polylines, pixels. If y points up, the covered area lies to the left of each line,
// also around holes.
//   points   #P positions, pixels; NaN for a point behind the eye, whose triangles are left out
//   corners  #T by 3 indices of points: the triangles
//   picture  triangles are clipped to this rectangle, and their outline follows its border there
//   cell     edge of a cell, pixels
std::vector<std::vector<glm::vec2>> silhouette(const std::vector<glm::vec2>& points,
                                               const std::vector<glm::u32vec3>& corners, const Rect& picture,
                                               float cell);

}  // namespace limber::editor
