// SPDX-License-Identifier: AGPL-3.0-or-later
// Where each named widget of the last frame lies, and each text that was shown: what scripts click and tests measure.
// A name is a path from its region ("sidebar/Tissues/Muscle/eye"); any ending of the path finds it when it is the only
// one.
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
  Rect rect;  // the visible part
  bool enabled = true;
};

class WidgetRegistry {
 public:
  void begin_frame();
  void add(Widget widget) { building_.push_back(std::move(widget)); }
  void add_text(std::string text) { building_texts_.push_back(std::move(text)); }
  void end_frame();

  // Of the last complete frame; nullptr for none. Throws Error when two different widgets end in `name`.
  const Widget* find(std::string_view name) const;
  const std::vector<Widget>& widgets() const { return shown_; }
  const std::vector<std::string>& texts() const { return shown_texts_; }

 private:
  std::vector<Widget> building_, shown_;
  std::vector<std::string> building_texts_, shown_texts_;
};

}  // namespace limber::editor
