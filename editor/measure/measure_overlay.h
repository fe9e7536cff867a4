// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the measurements over a view: lines between their points, an arc at an angle, the tape of a girth, and plates
// with the values.
#pragma once

#include <string>
#include <vector>

#include "core/measure/measurement.h"
#include "editor/context/view_projection.h"

namespace limber::editor {

// Draws the document's measurements where the body of the view's scene has them. In a slice, only those near its plane.
void draw_measurements_over(Editor& editor, const ViewPlace& place);

// Draws one measurement, complete or not.
//   points  its points on the shown body, world, mm
//   words   the lines of its plate; the first one is bright; empty: no plate
//   taken   plates that are drawn already, which the new plate does not cover; gets the new plate
void draw_measure(Editor& editor, const ViewProjection& view, MeasureKind kind, const std::vector<glm::dvec3>& points,
                  const std::vector<std::string>& words, bool is_chosen, std::vector<Rect>& taken);

}  // namespace limber::editor
