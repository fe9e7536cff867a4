// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/widgets.h"

#include <imgui_internal.h>

namespace limber::editor {

namespace {

constexpr ImGuiWindowFlags kRegionFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                          ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                                          ImGuiWindowFlags_NoScrollWithMouse | ImGuiWindowFlags_NoNav;

std::string path_of(const Ui& ui, const std::string& name) {
  std::string path;
  for (const std::string& step : ui.place.steps)
    if (!step.empty()) path += step + "/";
  return path + name;
}

struct ButtonColours {
  Colour background, text, edge;
};

ButtonColours colours_of(const Theme& theme, const ButtonLook& look, const Pressed& state) {
  if (!look.enabled)
    return {look.style == ButtonStyle::Flat ? 0 : theme.head, theme.text3,
            look.style == ButtonStyle::Flat ? 0 : theme.line};
  const Colour pressed = state.held && state.hovered ? theme.active : state.hovered ? theme.hover : 0;
  switch (look.style) {
    case ButtonStyle::Primary:
    case ButtonStyle::Chosen: return {theme.accent, theme.on_accent, 0};
    case ButtonStyle::Soft: return {theme.accent_soft, theme.accent_text, theme.accent};
    case ButtonStyle::Flat: return {pressed, theme.text, 0};
    case ButtonStyle::Plain: break;
  }
  return {pressed ? pressed : theme.raised, theme.text, 0};
}

}  // namespace

void push_path(Ui& ui, const std::string& step) {
  ui.place.steps.push_back(step);
  ImGui::PushID(step.c_str());
}

void pop_path(Ui& ui) {
  ui.place.steps.pop_back();
  ImGui::PopID();
}

void begin_region(Ui& ui, Region region, const std::string& name, const Rect& rect, Colour background) {
  ui.place.region = region;
  if (region != Region::Dialog) ui.place.windows.push_back("##" + name);
  ImGui::SetNextWindowPos(im(rect.low));
  ImGui::SetNextWindowSize(im(rect.size()));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
  ImGui::PushStyleColor(ImGuiCol_WindowBg, background);
  // A region must not take the keyboard focus or close a menu when it appears. Only a dialog may.
  ImGui::Begin(("##" + name).c_str(), nullptr,
               kRegionFlags | (region == Region::Dialog ? 0 : ImGuiWindowFlags_NoFocusOnAppearing));
  ImGui::PopStyleColor();
  ImGui::PopStyleVar();
  // ImGui opens a new window behind the others, so a dialog is moved to the front in the frame in which it appears.
  // Menus that the dialog opens later lie in front of the dialog.
  if (region == Region::Dialog && ImGui::IsWindowAppearing())
    ImGui::BringWindowToDisplayFront(ImGui::GetCurrentWindow());
  push_path(ui, name);
}

void end_region(Ui& ui) {
  pop_path(ui);
  ImGui::End();
}

void register_widget(Ui& ui, const std::string& name, const Rect& rect, bool enabled) {
  const ImVec2 low = ImGui::GetWindowDrawList()->GetClipRectMin(), high = ImGui::GetWindowDrawList()->GetClipRectMax();
  const Rect visible = intersection(rect, {from_im(low), from_im(high)});
  if (!visible.empty()) ui.widgets.add({path_of(ui, name), ui.place.region, visible, enabled});
}

Pressed press_area(Ui& ui, const std::string& name, const Rect& rect, bool enabled) {
  Pressed pressed;
  if (rect.empty()) return pressed;
  const ImVec2 back = ImGui::GetCursorScreenPos();
  ImGui::SetCursorScreenPos(im(rect.low));
  const bool clicked = ImGui::InvisibleButton(name.c_str(), im(rect.size()));
  pressed.hovered = ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled);
  pressed.held = enabled && ImGui::IsItemActive();
  pressed.activated = enabled && ImGui::IsItemActivated();
  pressed.clicked = enabled && clicked;
  pressed.double_clicked = enabled && pressed.hovered && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
  pressed.right_clicked = enabled && pressed.hovered && ImGui::IsMouseClicked(ImGuiMouseButton_Right);
  register_widget(ui, name, rect, enabled);
  ImGui::SetCursorScreenPos(back);
  return pressed;
}

static ImFont* font_of_button(const Ui& ui, ButtonStyle style) {
  return style == ButtonStyle::Primary || style == ButtonStyle::Chosen ? ui.look.fonts.semibold : ui.look.fonts.regular;
}

float width_of_button(const Ui& ui, const ButtonLook& look) {
  const float words = look.label.empty() ? 0 : text_size(font_of_button(ui, look.style), look.label).x;
  const float icon = *look.icon ? ui.look.px(16) : 0;
  const float gap = words > 0 && icon > 0 ? ui.look.px(8) : 0;
  return std::round(words + icon + gap + 2 * ui.look.px(words > 0 ? 11 : 7));
}

bool button(Ui& ui, const std::string& name, const Rect& rect, const ButtonLook& look) {
  const Pressed pressed = press_area(ui, name, rect, look.enabled);
  const ButtonColours colours = colours_of(ui.look.theme, look, pressed);
  const float rounding = ui.look.px(4);
  if (colours.background) fill(rect, colours.background, rounding);
  if (colours.edge) outline(rect, colours.edge, rounding, ui.look.line());

  ImFont* font = font_of_button(ui, look.style);
  const float icon = *look.icon ? ui.look.px(16) : 0, gap = icon > 0 && !look.label.empty() ? ui.look.px(8) : 0;
  const float words = std::min(text_size(font, look.label).x, rect.width() - icon - gap - ui.look.px(8));
  float x = std::round(rect.centre().x - (icon + gap + words) / 2);
  if (icon > 0)
    put_icon(ui.look.fonts.regular, colours.text, Rect{{x, rect.low.y}, {x + icon, rect.high.y}}, look.icon);
  if (!look.label.empty())
    put_text(ui, font, colours.text, Rect{{x + icon + gap, rect.low.y}, {x + icon + gap + words + 1, rect.high.y}},
             look.label);
  return pressed.clicked;
}

}  // namespace limber::editor
