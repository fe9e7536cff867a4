// SPDX-License-Identifier: AGPL-3.0-or-later
// Tool tips: name, key, one sentence; beside the thing that is pointed at, never over it, after a moment of rest.
#pragma once

#include <optional>
#include <string>

#include "editor/editor.h"

namespace limber::editor {

// For the item just drawn, when it is pointed at.
void tooltip(Editor& editor, const Rect& rect, const std::string& title, const std::string& sentence, const std::optional<Chord>& chord = {});
void operator_tooltip(Editor& editor, const Operator& op, const Rect& rect);
void draw_tooltip(Editor& editor);

}  // namespace limber::editor
