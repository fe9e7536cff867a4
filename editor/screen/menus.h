// SPDX-License-Identifier: AGPL-3.0-or-later
// Defines and draws the menus. An entry is an operator's id, "-" for a separator, or "> Title" and "<" around a
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
// Returns the menu of this name, which opens at the pointer. "context" is the view's context menu. Operators open
// "Views", "Display", "Snap", "Similar" and "Workspaces". "Bone" and "Posed bone" are for the selected bones; "Volume",
// "Tissue", "Armature" and "Result" are for rows of the outliner.
Menu pointer_menu(const std::string& name, ViewId view);

// Draws a menu's rows into an open popup. Omits ids to which no operator belongs, and submenus without any operator.
void draw_menu(Editor& editor, const Menu& menu);

}  // namespace limber::editor
