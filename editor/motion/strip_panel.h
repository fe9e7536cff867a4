// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the strips in place of the timeline's rows: the tracks' names with their switches, and the strips on the
// tracks.
#pragma once

#include "editor/motion/strip_view.h"

namespace limber::editor {

struct Context;
struct Rect;

void draw_strips(Context& context, const Rect& rect);

}  // namespace limber::editor
