// SPDX-License-Identifier: AGPL-3.0-or-later
// Functions for the comparison of two results A and B in one view, which shows A at the left and B at the right of a
// dividing line. They find which result a view shows, and which result lies under the pointer.
#pragma once

#include <optional>

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
// Returns the point of the body at a pixel of the 3D view, with its voxel at rest also if the view shows a refined
// pose.
std::optional<render::Hit> pick_body(const Context& context, const ViewPlace& place, const glm::ivec2& pixel);

}  // namespace limber::editor
