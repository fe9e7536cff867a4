// SPDX-License-Identifier: AGPL-3.0-or-later
// What bones are called and how their own axes lie, written over the 3D view. A name stands beside its bone, where
// nothing else is written and outside the gizmo; one that finds no such place is left out, the nearest bones' last.
#pragma once

#include "editor/context/view_projection.h"

namespace limber::editor {

void draw_bone_labels(Editor& editor, const ViewProjection& view);

}  // namespace limber::editor
