// SPDX-License-Identifier: AGPL-3.0-or-later
// Converts the user's brush settings into the settings of a stroke, and tells whether and where brushes can paint.
#pragma once

#include <optional>
#include <string>

#include "core/paint/stroke.h"
#include "editor/skin/painting.h"

namespace limber::editor {

struct Context;
struct ViewPlace;

// Returns the position where a brush at this pixel of the view would paint; no value if the pixel shows no tissue.
std::optional<BrushPlace> brush_place(Context& context, const ViewPlace& view, const glm::vec2& pixel);

// Returns why painting is impossible now ("There are no weights"); "" when it is possible.
std::string why_not_paint(const Context& context);
// Returns why a brush with the current settings would reach no tissue; "" when it would reach some.
std::string why_brush_reaches_nothing(const Context& context);

// Returns the settings of a stroke: from the brush's settings, the selected bones, the locked bones, the clip box and
// plane, and the region that limits brushes.
StrokeSettings stroke_settings(const Context& context, BrushKind kind);
// Returns how strokes normalize weights. This is the user's setting, except that WhenComposed becomes Unlocked when
// the base weights or a mask are painted: only a layer's weights can be normalized when the layers are composed.
Normalize normalize_of(const Context& context);

}  // namespace limber::editor
