// SPDX-License-Identifier: AGPL-3.0-or-later
// Selects what the timeline shows: the rows with markers, clip and keys; the graph editor; or the strips.
#pragma once

namespace limber::editor {

struct Context;
struct Rect;
struct Timeline;

enum class TimelineFace { Rows, Graph, Strips };
TimelineFace shown_face(const Timeline& timeline);
void show_face(Context& context, TimelineFace face);
// Draws the button beside the ruler that names what the timeline shows and opens a list of the three choices.
void draw_face_switch(Context& context, const Rect& place);

}  // namespace limber::editor
