// SPDX-License-Identifier: AGPL-3.0-or-later
// The stroke that the brush of the Skin workspace paints. It shows its weights in the document's place
// (Views::preview_weights) and becomes one edit when the button is let go; Escape drops it.
#pragma once

#include "editor/skin/brush_settings.h"

namespace limber::editor {

// Paints with that brush from the pointer on, until the button is let go.
void begin_stroke(Editor& editor, BrushKind kind);
// Of the stroke that is being painted; 0 where none is.
int dabs_of_stroke(const Editor& editor);
// Once a frame.
void follow_brush(Editor& editor);
// Over a view: the ring of the brush, and of the one that mirrors it.
void draw_brush(Editor& editor, const ViewPlace& view);

}  // namespace limber::editor
