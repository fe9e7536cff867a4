// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the measurements over a view: lines between their points, an arc for an angle, the tape of a girth, and labels
// with the values.
#pragma once

#include <string>
#include <vector>

#include "core/measure/measurement.h"
#include "editor/ui/rect.h"

namespace limber::editor {

struct Context;
struct Ui;
struct ViewPlace;
struct ViewProjection;

// Draws the document's measurements at their positions on the body that the view shows. A slice shows only
// measurements near its plane.
void draw_measurements_over(Context& context, const ViewPlace& place);

// Draws one measurement's lines and points. The measurement may still lack points.
//   points  its points on the shown body, world, mm
void draw_measure_lines(Context& context, const ViewProjection& view, MeasureKind kind,
                        const std::vector<glm::dvec3>& points, bool is_chosen);

// Draws one measurement's label.
//   words   the lines of the label; the first line is bright; empty: no label
//   taken   rectangles of the labels drawn so far, which the new label avoids; the new label's rectangle is appended
void draw_measure_label(Ui& ui, const ViewProjection& view, MeasureKind kind, const std::vector<glm::dvec3>& points,
                        const std::vector<std::string>& words, bool is_chosen, std::vector<Rect>& taken);

}  // namespace limber::editor
