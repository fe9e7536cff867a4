// SPDX-License-Identifier: AGPL-3.0-or-later
// Where brushes may paint, and with which settings.
#pragma once

#include <optional>
#include <string>

#include "core/paint/stroke.h"
#include "editor/context/editor.h"
#include "editor/skin/painting.h"

namespace limber::editor {

// Where a brush at this pixel would paint; nothing beside the body.
std::optional<BrushPlace> brush_place(Editor& editor, const ViewPlace& view, const glm::vec2& pixel);

// Why nothing can be painted now: "There are no weights"; "" when it can.
std::string why_not_paint(const Editor& editor);
// Why a brush would reach no tissue, as it is set; "" when it would.
std::string why_brush_reaches_nothing(const Editor& editor);

// What the brushes may change, and the bones they paint, as set now.
StrokeSettings stroke_settings(const Editor& editor, BrushKind kind);
// The base and masks have none to leave it to: they are normalized as they are painted.
Normalize normalize_of(const Editor& editor);

}  // namespace limber::editor
