// SPDX-License-Identifier: AGPL-3.0-or-later
// Tool tips: name, key, one sentence; beside the thing that is pointed at, never over it, after a moment of rest.
#pragma once

#include <optional>
#include <string>

#include "editor/ui/ui.h"

namespace limber::editor {

// For the item just drawn, when it is pointed at.
void tooltip(Ui& ui, const Rect& rect, const std::string& title, const std::string& description,
             const std::optional<Chord>& chord = {});
void draw_tooltip(Ui& ui);

}  // namespace limber::editor
