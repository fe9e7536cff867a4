// SPDX-License-Identifier: AGPL-3.0-or-later
// Defines and draws the menus. An entry is an operator's id, "-" for a separator, or "> Title" and "<" around a
// submenu.
#pragma once

#include <string>
#include <vector>

#include "editor/context/view_place.h"

namespace limber::editor {

struct Context;

struct Menu {
  std::string title;
  std::vector<std::string> entries;
};
std::vector<Menu> menus();
// Returns a menu that opens at the pointer, by its name. "context" is the context menu of the view `view`. "Bone" and
// "Posed bone" are menus for the selected bones. "Volume", "Tissue", "Rig" and "Result" belong to rows of the
// outliner. "Views", "Display", "Snap", "Similar" and "Workspaces" are opened by operators.
Menu pointer_menu(const std::string& name, ViewId view);

// Draws the rows of a menu into an open popup. Leaves out the ids of unknown operators, and submenus that would be
// empty.
void draw_menu(Context& context, const Menu& menu);

}  // namespace limber::editor
