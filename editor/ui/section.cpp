// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/section.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <imgui_internal.h>

#include "editor/ui/icons.h"
#include "editor/ui/list_navigation.h"

namespace limber::editor {

namespace {

// Stores the y of a section's head in the sidebar window's storage, even if the head is scrolled out of sight.
// screen/steady.cpp reads this y, to keep the widget under the pointer from moving.
void note_section(const char* title, float y) {
  ImGuiWindow* root = ImGui::GetCurrentWindow()->RootWindow;
  if (std::string_view(root->Name) == "##sidebar") root->StateStorage.SetFloat(ImHashStr(title), y);
}

}  // namespace

Column::Column(Ui& ui, const std::string& name, const Rect& area) : ui_(ui), area_(area) {
  push_path(ui, name);
  ImGui::SetCursorScreenPos(im(area.low));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
  ImGui::BeginChild("column", im(area.size()), false, ImGuiWindowFlags_NoNav);
  ImGui::PopStyleVar();
  // The column always leaves room for the scroll bar, so that the rows keep their width when the scroll bar appears.
  width_ = std::min(ImGui::GetContentRegionAvail().x, area.width() - ImGui::GetStyle().ScrollbarSize);
  y_ = top_ = ImGui::GetCursorScreenPos().y;
}

Column::~Column() {
  ImGui::SetCursorScreenPos({area_.low.x, y_});
  ImGui::Dummy({1, 0});
  ImGui::EndChild();
  pop_path(ui_);
}

Rect Column::row(float height) {
  const Rect rect{{area_.low.x, y_}, {area_.low.x + width_, y_ + ui_.look.px(height)}};
  y_ = rect.high.y;
  return rect;
}

bool Column::begin_section(const std::string& title, const std::string& right, bool open_at_first) {
  const Look& look = ui_.look;
  bool& open = ui_.open_sections.try_emplace(title, open_at_first).first->second;
  const Rect rect = head_ = row(28);
  note_section(title.c_str(), rect.low.y);
  if (ui_.wanted_section == title) {
    ImGui::SetScrollY(ImGui::GetScrollY() + rect.low.y - area_.low.y);
    ui_.wanted_section.clear();
    ui_.touch();
  }
  push_path(ui_, title);
  // A click on the head folds or unfolds the section, except in the 90 pixels (at scale 1) at its right end, where
  // panels put buttons.
  const Pressed pressed = press_area(ui_, "fold", {rect.low, {rect.high.x - look.px(90), rect.high.y}});
  fill(rect, look.theme.head);
  fill({rect.low, {rect.high.x, rect.low.y + look.line()}}, look.theme.void_);
  put_icon(look.fonts.regular, look.theme.text2,
           Rect{{rect.low.x + look.px(10), rect.low.y}, {rect.low.x + look.px(26), rect.high.y}},
           open ? icon::kOpened : icon::kClosed);
  put_text(ui_, look.fonts.semibold, look.theme.text,
           Rect{{rect.low.x + look.px(34), rect.low.y}, {rect.high.x - look.px(100), rect.high.y}}, title);
  // The text at the right gets the width that the title leaves free.
  const float words = rect.low.x + look.px(34 + 12) + text_size(look.fonts.semibold, title).x;
  if (!right.empty())
    put_text(ui_, look.fonts.small, look.theme.text2,
             Rect{{words, rect.low.y}, {rect.high.x - look.px(10), rect.high.y}}, right, Align::Right);
  if (pressed.clicked) {
    open = !open;
    ui_.touch();
  }
  return open;
}

void Column::end_section() { pop_path(ui_); }

Rect Column::property(const std::string& label) {
  const Look& look = ui_.look;
  const Rect rect = row(26);
  const float inset = look.px(2);
  put_text(ui_, look.fonts.regular, look.theme.text2,
           Rect{{rect.low.x + look.px(10), rect.low.y}, {rect.low.x + look.px(114), rect.high.y}}, label);
  return {{rect.low.x + look.px(122), rect.low.y + inset}, {rect.high.x - look.px(10), rect.high.y - inset}};
}

bool Column::list_row(Rect& rect, int index, bool chosen, const std::string& list) {
  const Look& look = ui_.look;
  rect = row(24);
  const bool focused = !list.empty() && has_focus(ui_, list, index);
  if (focused && std::exchange(ui_.list_focus.reveal, false)) {
    if (rect.low.y < area_.low.y) ImGui::SetScrollY(ImGui::GetScrollY() - (area_.low.y - rect.low.y));
    if (rect.high.y > area_.high.y) ImGui::SetScrollY(ImGui::GetScrollY() + rect.high.y - area_.high.y);
    ui_.touch();
  }
  // While the user types into a text field, every row is drawn, because a field that is not drawn loses the keyboard.
  const bool typed = ui_.renaming || ui_.keyboard.typed || ui_.keyboard.waits();
  if (!typed && !ImGui::IsRectVisible(im(rect.low), im(rect.high))) return false;
  if (chosen) fill(rect, look.theme.accent_soft);
  else if (index % 2) fill(rect, look.theme.row_alt);
  if (focused) outline(rect, look.theme.accent_text, 0, 2 * look.line());
  return true;
}

bool empty_state(Ui& ui, const Rect& rect, const std::string& line, const std::string& button_label) {
  const Look& look = ui.look;
  const glm::vec2 middle = rect.centre();
  const ButtonLook face{"", button_label, ButtonStyle::Plain};
  const float width = width_of_button(ui, face), height = look.px(26);
  put_text(ui, look.fonts.regular, look.theme.text2,
           Rect{{rect.low.x, middle.y - look.px(28)}, {rect.high.x, middle.y - look.px(8)}}, line, Align::Centre);
  const glm::vec2 corner = glm::round(glm::vec2(middle.x - width / 2, middle.y));
  return button(ui, button_label, {corner, corner + glm::vec2(width, height)}, face);
}

}  // namespace limber::editor
