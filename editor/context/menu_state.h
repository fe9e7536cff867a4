// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

namespace limber::editor {

struct MenuState {
  std::string open_menu;    // title of the top bar's open menu; "" for none
  std::string open_popup;   // the menu of menus.h to open at the pointer in the next frame; "" for none
  std::string shown_popup;  // the menu of menus.h that is open; "" for none
};

}  // namespace limber::editor
