// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "editor/context/platform_window.h"

struct ImGuiContext;

namespace limber::editor {

struct WindowState {
  ImGuiContext* imgui = nullptr;
  bool quit = false;
  Cursor cursor = Cursor::Arrow;  // the pointer's shape in this frame
  int hovered_splitter = -1;
  double splitter_since = 0;
};

}  // namespace limber::editor
