// SPDX-License-Identifier: AGPL-3.0-or-later
// Paints strokes in the Skin workspace. While a stroke runs, the views show its weights (Views::preview_weights)
// instead of the document's. Releasing the button commits the stroke as one edit; Escape discards it.
#pragma once

#include "editor/skin/brush_settings.h"

namespace limber::editor {

struct Context;
struct ViewPlace;

// Begins a stroke with this brush at the pointer. The stroke ends when the button is released.
void begin_stroke(Context& context, BrushKind kind);
// Returns the number of dabs (single touches of the brush) of the running stroke; 0 without a stroke.
int dabs_of_stroke(const SkinDisplay& skin);
// Moves the brush's cursor to the pointer. Call once per frame.
void follow_brush(Context& context);
// Draws the brush's ring over a view, and the mirrored ring if X mirror is on.
void draw_brush(Context& context, const ViewPlace& view);

}  // namespace limber::editor
