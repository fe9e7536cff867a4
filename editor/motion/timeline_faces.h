// SPDX-License-Identifier: AGPL-3.0-or-later
// The timeline's three faces: the rows with markers, clip and keys; the graph editor; the strips.
#pragma once

#include "editor/motion/timeline.h"

namespace limber::editor {

enum class TimelineFace { Rows, Graph, Strips };
TimelineFace shown_face(const Editor& editor);
void show_face(Editor& editor, TimelineFace face);
// Draws the button beside the ruler that names the shown face and opens a list of the three.
void draw_face_switch(Editor& editor, const Rect& place);

}  // namespace limber::editor
