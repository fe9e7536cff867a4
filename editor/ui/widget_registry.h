// SPDX-License-Identifier: AGPL-3.0-or-later
// Records the rectangle of each named widget and each text of a frame, so that scripts can click the widgets and tests
// can measure them. A widget's name is a path that begins with its region ("sidebar/Tissues/Muscle/eye"). A widget is
// found by its whole path, or by the last steps of its path if no other path ends in these steps.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "editor/ui/rect.h"

namespace limber::editor {

enum class Region { TopBar, ToolHeader, ToolStrip, Views, Sidebar, Bottom, Status, Popup, Dialog, Toast, Start };

struct Widget {
  std::string name;
  Region region = Region::Views;
  Rect rect;  // the visible part of the widget, pixels of the window
  bool enabled = true;
};

class WidgetRegistry {
 public:
  void begin_frame();
  void add(Widget widget) { building_.push_back(std::move(widget)); }
  void add_text(std::string text) { building_texts_.push_back(std::move(text)); }
  void end_frame();

  // Finds a widget of the last complete frame whose path is `name` or ends in `name`. Returns nullptr if there is none.
  // Throws Error when the paths of several widgets end in `name`.
  const Widget* find(std::string_view name) const;
  const std::vector<Widget>& widgets() const { return shown_; }
  const std::vector<std::string>& texts() const { return shown_texts_; }

 private:
  std::vector<Widget> building_, shown_;
  std::vector<std::string> building_texts_, shown_texts_;
};

}  // namespace limber::editor
