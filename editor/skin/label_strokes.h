// SPDX-License-Identifier: AGPL-3.0-or-later
// Strokes of the label brush. They paint the labels of the selected tissue, and erase them while Ctrl is held, in
// slices and on the body's surface in the 3D view. While a stroke runs, the views show its labels. Releasing the button
// commits the stroke as one edit; Escape discards it.
#pragma once

#include <optional>
#include <string>

#include "editor/labels/label_brush.h"
#include "editor/skin/painting.h"

namespace limber::editor {

class Column;
struct Context;

// Returns why the label brush cannot paint now; "" when it can.
std::string why_not_paint_labels(const Context& context);
// Returns the position where the label brush at this pixel would paint. In slices this may be in air.
std::optional<BrushPlace> label_brush_place(Context& context, const ViewPlace& view, const glm::vec2& pixel);
// Begins a stroke at the pointer. The stroke ends when the button is released.
void begin_label_stroke(Context& context, bool erases);
// Sets the range of image values when the user begins to limit strokes to a range. If the image is not a CT and the
// range still has its default values (bone in a CT), the range becomes that of all values of the image. Otherwise the
// range does not change.
void begin_range(Context& context);
void draw_label_brush_section(Context& context, Column& column);  // draws nothing while the brush is off

}  // namespace limber::editor
