// SPDX-License-Identifier: AGPL-3.0-or-later
// Shows tool tips, each with a name, a key and a description. After a short delay, the tool tip of the widget under the
// pointer appears below the widget, or above it where there is no room below.
#pragma once

#include <optional>
#include <string>

#include "editor/ui/ui.h"

namespace limber::editor {

// Requests a tool tip above or below the widget with the rectangle `rect`. Call it in each frame in which the pointer
// is over this widget.
void tooltip(Ui& ui, const Rect& rect, const std::string& title, const std::string& description,
             const std::optional<Chord>& chord = {});
void draw_tooltip(Ui& ui);

}  // namespace limber::editor
