// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the clip box and the clip plane in the 3D view: their edges, and square handles that the user drags along an
// axis. During a drag only a preview changes. The document changes once, when the handle is released.
#pragma once

#include "core/project/document.h"
#include "render/scene/camera.h"

namespace limber::editor {

struct Context;
struct Rect;

// Draws the clip box, the clip plane and their handles into the current ImGui window, over the 3D view that fills
// `rect`.
void draw_clip_handles(Context& context, const Rect& rect);

// Moves a face of the clip box to the voxel coordinate `voxel`. The face stays inside the grid and at least one voxel
// away from the opposite face.
void move_face(ClipBox& box, const Grid& grid, int axis, bool high, double voxel);

// Returns the distance by which a point moves along `direction` when the pointer drags the point by `pixels`. The
// distance is a multiple of the vector `direction`. Returns 0 if the vector points at the eye.
//   direction  a vector of any length, world coordinates
double along(const render::Camera& camera, const glm::ivec2& size, const glm::dvec3& point, const glm::dvec3& direction,
             const glm::dvec2& pixels);

}  // namespace limber::editor
