// SPDX-License-Identifier: AGPL-3.0-or-later
// Widgets that stand for operators: each shows the operator's tool tip, and why it cannot run.
#pragma once

#include <string>
#include <string_view>

#include "editor/ui/widgets.h"

namespace limber::editor {

struct Editor;
struct Operator;

// A button for an operator: its icon, label, tool tip and why it cannot run. `label` "" shows the icon alone.
bool operator_button(Editor& editor, std::string_view id, const Rect& rect, const std::string& label,
                     ButtonStyle style = ButtonStyle::Plain);

// A row of a popup for an operator.
void operator_menu_item(Editor& editor, std::string_view id);

// A check box for an operator that is on or off.
void operator_box(Editor& editor, std::string_view id, const Rect& rect, const std::string& label);

// Name, key, what it does, and why it cannot run now.
void operator_tooltip(Editor& editor, const Operator& op, const Rect& rect);

}  // namespace limber::editor
