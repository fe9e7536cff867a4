// SPDX-License-Identifier: AGPL-3.0-or-later
// Things that hold a value: check boxes, numbers, texts.
#pragma once

#include <string>
#include <vector>

#include "editor/ui/widgets.h"

namespace limber::editor {

void checkbox_mark(Ui& ui, const Rect& rect, bool on, bool hovered);
bool checkbox(Ui& ui, const std::string& name, const Rect& rect, const std::string& label, bool& on);
// A number that is dragged sideways, or typed after a double click; `fraction` < 0: no fill. True while it changes;
// `committed` when the drag or typing ended.
bool number_field(Ui& ui, const std::string& name, const Rect& rect, double& value, double low, double high,
                  const char* format, const char* unit, bool filled, bool& committed);
// The same where a typed number is taken as it is, to be judged by the caller; `focus`: it waits for typing.
bool judged_number_field(Ui& ui, const std::string& name, const Rect& rect, double& value, double low, double high,
                         const char* format, const char* unit, bool focus);
// One of a list, which opens below; its names stand in the caller's path. True when another was chosen.
bool choice_field(Ui& ui, const Rect& rect, const std::vector<std::string>& choices, int& chosen);
// True when Return or leaving the field accepted a changed text.
bool text_field(Ui& ui, const std::string& name, const Rect& rect, std::string& text, const char* hint = "",
                bool focus = false);

}  // namespace limber::editor
