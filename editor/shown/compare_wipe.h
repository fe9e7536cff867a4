// SPDX-License-Identifier: AGPL-3.0-or-later
// The two sides of a comparison: what the pointer is on belongs to side A left of the line, to side B right of it.
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

float wipe_line(const Editor& editor, const Rect& rect);  // x, pixels of the window
bool over_side_a(const Editor& editor, const ViewPlace& place);
const render::Scene& scene_of(const Editor& editor, const ViewPlace& place);  // of a view side by side; B's of a wipe
const render::Scene& scene_at_pointer(const Editor& editor, const ViewPlace& place);
const render::View3D& body_at_pointer(const Editor& editor, const ViewPlace& place);

}  // namespace limber::editor
