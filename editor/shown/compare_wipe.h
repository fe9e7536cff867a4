// SPDX-License-Identifier: AGPL-3.0-or-later
// For a comparison of two results A and B: finds which of them a view shows, or lies under the pointer. A is shown left
// of the dividing line, B right of it.
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

float wipe_line(const Editor& editor, const Rect& rect);  // x of the dividing line, pixels of the window
bool over_side_a(const Editor& editor, const ViewPlace& place);
// Returns the scene that a view shows. For a view that is divided by a wipe, returns the scene of result B.
const render::Scene& scene_of(const Editor& editor, const ViewPlace& place);
const render::Scene& scene_at_pointer(const Editor& editor, const ViewPlace& place);
const render::View3D& body_at_pointer(const Editor& editor, const ViewPlace& place);

}  // namespace limber::editor
