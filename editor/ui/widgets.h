// SPDX-License-Identifier: AGPL-3.0-or-later
// The editor's own widgets, built on ImGui's items and draw lists. They use the theme's colours, and register their
// rectangles under names by which scripts find them. Sizes are pixels of the window.
#pragma once

#include <string>
#include <string_view>

#include "editor/ui/draw.h"
#include "editor/ui/tooltip.h"

namespace limber::editor {

// --- Regions ---
// Begins an ImGui window that fills the rectangle. The paths of all widgets in the window begin with `name`.
void begin_region(Ui& ui, Region region, const std::string& name, const Rect& rect, Colour background);
void end_region(Ui& ui);
// Adds a step to the path with which the names of all following widgets begin, until pop_path() removes the step.
void push_path(Ui& ui, const std::string& step);
void pop_path(Ui& ui);
struct PathScope {
  PathScope(Ui& ui, const std::string& step) : ui_(ui) { push_path(ui, step); }
  ~PathScope() { pop_path(ui_); }
  Ui& ui_;
};

// --- Buttons and other areas to press ---
struct Pressed {
  bool hovered = false, held = false, clicked = false, double_clicked = false, right_clicked = false, activated = false;
};
// Adds an invisible item that can be pressed. The caller draws how it looks.
Pressed press_area(Ui& ui, const std::string& name, const Rect& rect, bool enabled = true);
void register_widget(Ui& ui, const std::string& name, const Rect& rect, bool enabled = true);

enum class ButtonStyle {
  Plain,
  Flat,
  Primary,
  Chosen,
  Soft
};  // Chosen: filled with the accent colour; Soft: a switch that is on, with an outline in the accent colour
struct ButtonLook {
  const char* icon = "";
  std::string label;
  ButtonStyle style = ButtonStyle::Plain;
  bool enabled = true;
};
bool button(Ui& ui, const std::string& name, const Rect& rect, const ButtonLook& look);
float width_of_button(const Ui& ui, const ButtonLook& look);

}  // namespace limber::editor
