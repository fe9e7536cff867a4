// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds what is under the pointer, since the meaning of keys and mouse buttons depends on it.
#pragma once

#include <string>
#include <vector>

namespace limber::editor {

struct Context;
struct Ui;
struct ViewPlace;

// Returns the names of the key map's contexts that apply at the pointer's position. If several of these contexts bind a
// key, the first one decides what the key does.
std::vector<std::string> contexts(const Context& context);
// Returns the view under the pointer; nullptr if the pointer is outside the views, or a menu or dialog covers them.
const ViewPlace* hovered_view(const Context& context);
// Returns true if the pointer is over the timeline's rows. The buttons above them do not count.
bool over_timeline(const Context& context);
// Returns true if the pointer is over a button, handle or bar in a view. These widgets handle the left mouse button
// themselves.
bool over_widget(const Ui& ui);

}  // namespace limber::editor
