// SPDX-License-Identifier: AGPL-3.0-or-later
// What stands in each menu, in order. An entry is an operator's id, "-" for a line, or "> Title" and "<" around a submenu.
#pragma once

#include <string>
#include <vector>

#include "editor/editor.h"

namespace limber::editor {

struct Menu {
  std::string title;
  std::vector<std::string> entries;
};
std::vector<Menu> menus();
// What is fitting under the pointer, for the right button.
Menu context_menu(ViewId view);

// The rows of a menu into an open popup; ids without an operator are left out, and so is what would then be empty.
void draw_menu(Editor& editor, const Menu& menu);

}  // namespace limber::editor
