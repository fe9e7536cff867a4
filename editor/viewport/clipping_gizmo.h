// SPDX-License-Identifier: AGPL-3.0-or-later
// The clip box and clip plane in the 3D view: edges, and squares that are dragged along their axis. While one is
// dragged the picture follows a preview; the document changes once, when it is released.
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

// Into the current window, over the 3D view that fills `rect`.
void draw_clip_handles(Editor& editor, const Rect& rect);

// A face to that voxel coordinate, within the grid and off the opposite face.
void move_face(ClipBox& box, const Grid& grid, int axis, bool high, double voxel);

// How far a point moves along `direction` (world, any length) when the pointer moves by `pixels`: multiples of it.
// 0 where the direction points at the eye.
double along(const render::Camera& camera, const glm::ivec2& size, const glm::dvec3& point, const glm::dvec3& direction,
             const glm::dvec2& pixels);

}  // namespace limber::editor
