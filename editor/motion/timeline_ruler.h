// SPDX-License-Identifier: AGPL-3.0-or-later
// The ruler with frames or seconds at the top of the timeline and of the graph editor, and the play head over both.
#pragma once

#include <vector>

#include "editor/ui/rect.h"

namespace limber::editor {

struct Context;

constexpr float kRulerHeight = 22;
constexpr float kRulerEnds = 12;  // free width at the right end of the rows, pixels at scale 1

// Returns the smallest of the numbers 1, 2 and 5 times a power of ten that is at least `least`.
double round_step(double least);
void draw_ruler(Context& context);
// Draws the play head. If there is room in the row of markers, draws the time beside it in the unit that the ruler does
// not show (frames or seconds).
//   covered  rectangles that the markers cover, pixels
void draw_play_head(Context& context, const std::vector<Rect>& covered);
// Scrolls the timeline when the play head has moved outside the shown frames. Does not scroll during a drag.
void follow_head(Context& context);

}  // namespace limber::editor
