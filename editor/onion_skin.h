// SPDX-License-Identifier: AGPL-3.0-or-later
// Ghosts of the skeleton at frames before and after the one that is shown: outlines over the 3D view, past ones in one
// colour, coming ones in another, each further one half as strong. Only frames of the range that plays.
#pragma once

#include "editor/editor.h"

namespace limber::editor {

void draw_onion_skin(Editor& editor);

}  // namespace limber::editor
