// SPDX-License-Identifier: AGPL-3.0-or-later
// The editor's own widgets, on ImGui's items and draw lists: they know the theme's colours and the grid of sizes, give
// their rectangle a name for scripts, and show a tool tip with name, key and sentence. Sizes are pixels of the window.
#pragma once

#include <string>
#include <string_view>

#include "editor/ui/draw.h"
#include "editor/ui/tooltip.h"

namespace limber::editor {

// --- Regions ---
// A window of ImGui that fills the rectangle; the name begins every widget's path.
void begin_region(Ui& ui, Region region, const std::string& name, const Rect& rect, Colour background);
void end_region(Ui& ui);
// Inside another region: the same path with one more step.
void push_path(Ui& ui, const std::string& step);
void pop_path(Ui& ui);
struct PathScope {
  PathScope(Ui& ui, const std::string& step) : ui_(ui) { push_path(ui, step); }
  ~PathScope() { pop_path(ui_); }
  Ui& ui_;
};

// --- Things to press ---
struct Pressed {
  bool hovered = false, held = false, clicked = false, double_clicked = false, right_clicked = false, activated = false;
};
// An invisible item; what is drawn for it is the caller's.
Pressed press_area(Ui& ui, const std::string& name, const Rect& rect, bool enabled = true);
void register_widget(Ui& ui, const std::string& name, const Rect& rect, bool enabled = true);

enum class ButtonStyle { Plain, Flat, Primary, Chosen, Soft };  // Chosen: accent fill; Soft: on, with an accent edge
struct ButtonLook {
  const char* icon = "";
  std::string label;
  ButtonStyle style = ButtonStyle::Plain;
  bool enabled = true;
};
bool button(Ui& ui, const std::string& name, const Rect& rect, const ButtonLook& look);
float width_of_button(const Ui& ui, const ButtonLook& look);

}  // namespace limber::editor
