// SPDX-License-Identifier: AGPL-3.0-or-later
// Handles the pointer in the strips' view: selects, moves and trims strips, draws selection rectangles and pans.
//
// Dragged strips snap to the ends of other strips and to the play head; Ctrl switches this off. They do not overlap
// other strips, unless Shift is held: strips of one track that overlap cross-fade.
#pragma once

#include "editor/motion/strip_view.h"

namespace limber::editor {

struct Context;

// Handles a press of the left button. On an end of a strip, trims it. On a strip, selects it (Shift: adds it to the
// selection, or removes it when the button is released without a drag) and drags the selected strips. Elsewhere, begins
// a rectangle that selects the strips that it touches.
void press_strips(Context& context);
// Begins a modal tool that moves the selected strips in time by the pointer or a typed number.
void begin_moving_strips(Context& context);
// Copies the selected strips and begins to move the copies.
void begin_duplicating_strips(Context& context);
void pan_strips(Context& context);

}  // namespace limber::editor
