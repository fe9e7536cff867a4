// SPDX-License-Identifier: AGPL-3.0-or-later
// The editor's own widgets, on ImGui's items and draw lists: they know the theme's colours and the grid of sizes, give
// their rectangle a name for scripts, and show a tool tip with name, key and sentence. Sizes are pixels of the window.
#pragma once

#include <string>
#include <string_view>

#include "editor/paint.h"
#include "editor/tooltip.h"

namespace limber::editor {

// --- Regions ---
// A window of ImGui that fills the rectangle; the name begins every widget's path.
void begin_region(Editor& editor, Region region, const std::string& name, const Rect& rect, Colour background);
void end_region(Editor& editor);
// Inside another region: the same path with one more step.
void push_path(Editor& editor, const std::string& step);
void pop_path(Editor& editor);
struct PathScope {
  PathScope(Editor& editor, const std::string& step) : editor_(editor) { push_path(editor, step); }
  ~PathScope() { pop_path(editor_); }
  Editor& editor_;
};

// --- Things to press ---
struct Pressed {
  bool hovered = false, held = false, clicked = false, double_clicked = false, right_clicked = false, activated = false;
};
// An invisible item; what is drawn for it is the caller's.
Pressed press_area(Editor& editor, const std::string& name, const Rect& rect, bool enabled = true);
void register_widget(Editor& editor, const std::string& name, const Rect& rect, bool enabled = true);

enum class ButtonStyle { Plain, Flat, Primary, Chosen, Soft };  // Chosen: accent fill; Soft: on, with an accent edge
struct ButtonLook {
  const char* icon = "";
  std::string label;
  ButtonStyle style = ButtonStyle::Plain;
  bool enabled = true;
};
bool button(Editor& editor, const std::string& name, const Rect& rect, const ButtonLook& look);
float width_of_button(const Editor& editor, const ButtonLook& look);
// A button for an operator: its icon, label, tool tip and why it cannot run. `label` "" shows the icon alone.
bool operator_button(Editor& editor, std::string_view id, const Rect& rect, const std::string& label, ButtonStyle style = ButtonStyle::Plain);

// A row of a popup for an operator.
void operator_menu_item(Editor& editor, std::string_view id);

}  // namespace limber::editor
