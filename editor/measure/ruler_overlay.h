// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws rulers along the lower and the left edge of a slice: ticks at round world coordinates, with their numbers in
// mm.
#pragma once

#include "editor/ui/rect.h"

namespace limber::editor {

struct Context;
struct ViewPlace;

void draw_rulers(Context& context, const ViewPlace& place);
// Returns the part of a slice's rectangle that the rulers do not cover.
Rect beside_rulers(const Context& context, const Rect& slice);

// Returns the distance between two numbered ticks, mm: 1, 2 or 5 times a power of ten, at least `least` mm.
double ruler_step(double least);

}  // namespace limber::editor
