// SPDX-License-Identifier: AGPL-3.0-or-later
// Paints strokes in the Skin workspace. While a stroke runs, the views show its weights (Views::preview_weights)
// instead of the document's. Releasing the button commits the stroke as one edit; Escape discards it.
#pragma once

#include "editor/skin/brush_settings.h"

namespace limber::editor {

// Begins a stroke with this brush at the pointer. The stroke ends when the button is released.
void begin_stroke(Editor& editor, BrushKind kind);
// Returns the number of dabs of the running stroke; 0 without a stroke.
int dabs_of_stroke(const Editor& editor);
// Moves the brush's cursor to the pointer. Call once per frame.
void follow_brush(Editor& editor);
// Draws the brush's ring over a view, and the mirrored ring if X mirror is on.
void draw_brush(Editor& editor, const ViewPlace& view);

}  // namespace limber::editor
