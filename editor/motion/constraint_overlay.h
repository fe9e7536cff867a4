// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the constraints of the shown clip over the 3D view: a thin dashed line from each constrained bone to its
// target, and a small diamond at the target position. The lines of selected bones are brighter.
#pragma once

namespace limber::editor {

struct Context;

void draw_constraint_lines(Context& context);

}  // namespace limber::editor
