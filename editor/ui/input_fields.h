// SPDX-License-Identifier: AGPL-3.0-or-later
// Widgets that hold a value: check boxes, number fields, drop-down lists, text fields.
#pragma once

#include <string>
#include <vector>

#include "editor/ui/widgets.h"

namespace limber::editor {

void checkbox_mark(Ui& ui, const Rect& rect, bool on, bool hovered);
bool checkbox(Ui& ui, const std::string& name, const Rect& rect, const std::string& label, bool& on);
// Draws a field for a number, which the user drags sideways or types. The number is clamped to [low, high]. If `filled`
// is true, a bar in the field shows where the number is in this range. Returns true in each frame in which the number
// changes. `committed` is true in the frame in which the drag or typing ends.
bool number_field(Ui& ui, const std::string& name, const Rect& rect, double& value, double low, double high,
                  const char* format, const char* unit, bool filled, bool& committed);
// Draws a number field that does not clamp a typed number to [low, high]. The caller checks the number. If `focus` is
// true, the field gets the keyboard.
bool judged_number_field(Ui& ui, const std::string& name, const Rect& rect, double& value, double low, double high,
                         const char* format, const char* unit, bool focus);
// Draws a drop-down list. Its widgets have the same names in every list, so the caller must push a path (push_path())
// that is unique to this field. Returns true when the user selected another choice.
bool choice_field(Ui& ui, const Rect& rect, const std::vector<std::string>& choices, int& chosen);
// Draws a text field. Returns true when the user has changed the text and pressed Return or left the field.
bool text_field(Ui& ui, const std::string& name, const Rect& rect, std::string& text, const char* hint = "",
                bool focus = false);

}  // namespace limber::editor
