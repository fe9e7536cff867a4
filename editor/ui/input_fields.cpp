// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/input_fields.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include "editor/ui/icons.h"
#include "editor/ui/keyboard.h"

namespace limber::editor {

namespace {
// Requests the keyboard for the text or number field that is drawn next.
void ask_for_keyboard(Ui& ui, const std::string& id) {
  ImGui::SetKeyboardFocusHere();
  await_field(ui, ImGui::GetID(id.c_str()));
}

constexpr double kFastest = 1;  // a drag by one pixel changes a number by at most this

// Returns the margin at the left and right of a field's text, pixels. A narrow field has a smaller margin, so that more
// digits fit.
float margin_of(const Look& look, const Rect& field) { return look.px(field.width() < look.px(64) ? 4 : 7); }
}  // namespace

void checkbox_mark(Ui& ui, const Rect& rect, bool on, bool hovered) {
  const Look& look = ui.look;
  fill(rect, on ? look.theme.accent : hovered ? look.theme.hover : look.theme.field, look.px(3));
  if (!on) outline(rect, look.theme.line2, look.px(3), look.line());
  if (on) put_icon(look.fonts.small, look.theme.on_accent, rect, icon::kTick);
}

bool checkbox(Ui& ui, const std::string& name, const Rect& rect, const std::string& label, bool& on) {
  const Look& look = ui.look;
  const Pressed pressed = press_area(ui, name, rect);
  const float side = look.px(16), y = std::round(rect.centre().y - side / 2);
  checkbox_mark(ui, {{rect.low.x, y}, {rect.low.x + side, y + side}}, on, pressed.hovered);
  put_text(ui, look.fonts.regular, look.theme.text, Rect{{rect.low.x + side + look.px(6), rect.low.y}, rect.high},
           label);
  if (pressed.clicked) on = !on;
  return pressed.clicked;
}

namespace {

bool any_number_field(Ui& ui, const std::string& name, const Rect& rect, double& value, double low, double high,
                      const char* format, const char* unit, bool filled, bool& committed, ImGuiSliderFlags flags) {
  const Look& look = ui.look;
  committed = false;
  // The code below draws the number and its unit, aligned to the right. ImGui's own text of the number is therefore
  // transparent, except while the user types the number.
  const std::string id = "##" + name;
  ImGui::SetCursorScreenPos(im(rect.low));
  ImGui::SetNextItemWidth(rect.width());
  ImGui::PushFont(look.fonts.mono);
  ImGui::PushStyleColor(ImGuiCol_Text,
                        with_alpha(look.theme.text, ImGui::TempInputIsActive(ImGui::GetID(id.c_str())) ? 1 : 0));
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding,
                      ImVec2(margin_of(look, rect), std::round((rect.height() - look.fonts.mono->FontSize) / 2)));
  const double speed = std::clamp((high - low) / std::max(1.0f, rect.width()), 1e-6, kFastest);
  const bool changed = ImGui::DragScalar(id.c_str(), ImGuiDataType_Double, &value, static_cast<float>(speed), &low,
                                         &high, format, flags);
  const bool typing = ImGui::TempInputIsActive(ImGui::GetItemID());
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
  ImGui::PopFont();
  committed = ImGui::IsItemDeactivatedAfterEdit();
  register_widget(ui, name, rect);
  if (typing) {
    // A double click selects the whole number, even while the user types it.
    if (ImGuiInputTextState* state = ImGui::GetInputTextState(ImGui::GetItemID());
        state && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left))
      state->SelectAll();
    return changed;
  }

  if (filled) {
    const float share = static_cast<float>(std::clamp((value - low) / (high - low), 0.0, 1.0));
    fill({rect.low + look.line(),
          {rect.low.x + look.line() + (rect.width() - 2 * look.line()) * share, rect.high.y - look.line()}},
         look.theme.accent_soft, look.px(3));
  }
  char written[48];
  std::snprintf(written, sizeof written, format, value);
  const char* text = written[0] == '-' && std::strtod(written, nullptr) == 0 ? written + 1 : written;
  float right = rect.high.x - margin_of(look, rect);
  if (*unit) {
    put_text(ui, look.fonts.small, look.theme.text2, Rect{rect.low, {right, rect.high.y}}, unit, Align::Right);
    right -= text_size(look.fonts.small, unit).x + look.px(4);
  }
  put_text(ui, look.fonts.mono, look.theme.text, Rect{rect.low, {right, rect.high.y}}, text, Align::Right);
  return changed;
}

}  // namespace

bool number_field(Ui& ui, const std::string& name, const Rect& rect, double& value, double low, double high,
                  const char* format, const char* unit, bool filled, bool& committed) {
  return any_number_field(ui, name, rect, value, low, high, format, unit, filled, committed,
                          ImGuiSliderFlags_AlwaysClamp);
}

bool judged_number_field(Ui& ui, const std::string& name, const Rect& rect, double& value, double low, double high,
                         const char* format, const char* unit, bool focus) {
  if (focus) ask_for_keyboard(ui, "##" + name);
  bool committed = false;
  return any_number_field(ui, name, rect, value, low, high, format, unit, false, committed, ImGuiSliderFlags_None);
}

bool choice_field(Ui& ui, const Rect& rect, const std::vector<std::string>& choices, int& chosen) {
  const Look& look = ui.look;
  const Pressed pressed = press_area(ui, "list", rect);
  fill(rect, pressed.hovered ? look.theme.hover : look.theme.raised, look.px(4));
  put_text(ui, look.fonts.regular, look.theme.text,
           Rect{{rect.low.x + look.px(10), rect.low.y}, {rect.high.x - look.px(24), rect.high.y}}, choices[chosen]);
  put_icon(look.fonts.regular, look.theme.text2, Rect{{rect.high.x - look.px(24), rect.low.y}, rect.high},
           icon::kOpened);
  if (pressed.clicked) ImGui::OpenPopup("choices");
  ImGui::SetNextWindowPos({rect.low.x, rect.high.y + look.px(2)});
  ImGui::SetNextWindowSizeConstraints({rect.width(), 0}, {rect.width(), look.px(240)});
  if (!ImGui::BeginPopup("choices", ImGuiWindowFlags_NoMove)) return false;
  const int before = chosen;
  for (int i = 0; i < static_cast<int>(choices.size()); ++i) {
    ImGui::PushID(i);
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x;
    if (ImGui::Selectable("##choice", i == chosen, 0, ImVec2(width, look.px(22)))) chosen = i;
    const Rect row{from_im(corner), {corner.x + width, corner.y + look.px(22)}};
    register_widget(ui, choices[i], row);
    put_text(ui, look.fonts.regular, look.theme.text, Rect{{row.low.x + look.px(8), row.low.y}, row.high}, choices[i]);
    ImGui::PopID();
  }
  ImGui::EndPopup();
  return chosen != before;
}

bool text_field(Ui& ui, const std::string& name, const Rect& rect, std::string& text, const char* hint, bool focus) {
  const Look& look = ui.look;
  ImGui::SetCursorScreenPos(im(rect.low));
  ImGui::SetNextItemWidth(rect.width());
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding,
                      ImVec2(look.px(8), std::round((rect.height() - look.fonts.regular->FontSize) / 2)));
  const std::string id = "##" + name;
  if (focus) ask_for_keyboard(ui, id);
  ImGui::InputTextWithHint(id.c_str(), hint, &text, ImGuiInputTextFlags_AutoSelectAll);
  ImGui::PopStyleVar();
  register_widget(ui, name, rect);
  return ImGui::IsItemDeactivatedAfterEdit();
}

}  // namespace limber::editor
