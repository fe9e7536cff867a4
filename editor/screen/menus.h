// SPDX-License-Identifier: AGPL-3.0-or-later
// What stands in each menu, in order. An entry is an operator's id, "-" for a line, or "> Title" and "<" around a
// submenu.
#pragma once

#include <string>
#include <vector>

#include "editor/context/editor.h"

namespace limber::editor {

struct Menu {
  std::string title;
  std::vector<std::string> entries;
};
std::vector<Menu> menus();
// A menu that opens at the pointer: "context" (what fits that view), "Views", "Display", "Snap", "Similar",
// "Workspaces", "Bone" and "Posed bone" (of the chosen ones), and of rows of the outliner "Volume", "Tissue",
// "Armature", "Result".
Menu pointer_menu(const std::string& name, ViewId view);

// The rows of a menu into an open popup; ids without an operator are left out, and so is what would then be empty.
void draw_menu(Editor& editor, const Menu& menu);

}  // namespace limber::editor
