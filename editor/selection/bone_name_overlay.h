// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the names and the local axes of the bones over the 3D view. A name is drawn beside its bone, where it covers
// neither other text nor the gizmo, and is left out if no such position is free. Names of the active bone, of selected
// bones and of bones near the eye are placed first.
#pragma once

namespace limber::editor {

struct Context;
struct ViewProjection;

void draw_bone_labels(Context& context, const ViewProjection& view);

}  // namespace limber::editor
