// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the graph editor in the place of the timeline's rows: at the left the list of tracks with a button for each
// channel, at the right the ruler and the curves with their keys and handles.
#pragma once

#include "editor/motion/graph.h"

namespace limber::editor {

struct Context;

void draw_graph(Context& context, const Rect& rect);

}  // namespace limber::editor
