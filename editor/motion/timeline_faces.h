// SPDX-License-Identifier: AGPL-3.0-or-later
// Selects what the timeline shows: the rows with markers, clip and keys; the graph editor; or the strips.
#pragma once

#include "editor/motion/timeline.h"

namespace limber::editor {

enum class TimelineFace { Rows, Graph, Strips };
TimelineFace shown_face(const Editor& editor);
void show_face(Editor& editor, TimelineFace face);
// Draws the button beside the ruler that names what the timeline shows and opens a list of the three choices.
void draw_face_switch(Editor& editor, const Rect& place);

}  // namespace limber::editor
