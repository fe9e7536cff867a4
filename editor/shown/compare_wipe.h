// SPDX-License-Identifier: AGPL-3.0-or-later
// Functions for the comparison of two results A and B in one view, which shows A at the left and B at the right of a
// dividing line. They find which result a view shows, and which result lies under the pointer.
#pragma once

#include "render/view.h"

namespace limber::editor {

struct Comparison;
struct Context;
struct Rect;
struct ViewPlace;

float wipe_line(const Comparison& comparison,
                const Rect& rect);  // returns the x of the line between A and B, window pixels
bool over_side_a(const Context& context, const ViewPlace& place);
// Returns the scene that a view shows. If a line divides the view between results A and B, returns the scene of B.
const render::Scene& scene_of(const Context& context, const ViewPlace& place);
const render::Scene& scene_at_pointer(const Context& context, const ViewPlace& place);
const render::View3D& body_at_pointer(const Context& context, const ViewPlace& place);

}  // namespace limber::editor
