// SPDX-License-Identifier: AGPL-3.0-or-later
// Buttons, menu rows and check boxes that run operators. Each shows the operator's tool tip, and if the operator cannot
// run now, the reason.
#pragma once

#include <string>
#include <string_view>

#include "editor/ui/widgets.h"

namespace limber::editor {

struct Context;
struct Operator;

// Draws an operator's button with its icon and `label`. An empty label leaves only the icon. Returns true if the button
// was clicked.
bool operator_button(Context& context, std::string_view id, const Rect& rect, const std::string& label,
                     ButtonStyle style = ButtonStyle::Plain);

// Returns the operator's label as it reads outside its menu: "Export volume..." for the entry "Volume..." of the
// submenu "Export".
std::string full_label(const Operator& op);

// Draws an operator's row in a popup menu.
//   submenu  title of the submenu that the row belongs to; "": none. The row shows the full label unless the submenu's
//            title completes it.
void operator_menu_item(Context& context, std::string_view id, std::string_view submenu = "");

// Draws a check box for an operator that switches something on and off.
void operator_box(Context& context, std::string_view id, const Rect& rect, const std::string& label);

// Shows the operator's tool tip: name, key, what it does, and why it cannot run now.
void operator_tooltip(Context& context, const Operator& op, const Rect& rect);

}  // namespace limber::editor
