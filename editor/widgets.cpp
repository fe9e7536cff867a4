// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/widgets.h"

#include <imgui_internal.h>

#include "editor/dispatch.h"
#include "editor/icons.h"

namespace limber::editor {

namespace {

constexpr ImGuiWindowFlags kRegionFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                                          ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoScrollWithMouse | ImGuiWindowFlags_NoNav;

std::string path_of(const Editor& editor, const std::string& name) {
  std::string path;
  for (const std::string& step : editor.place.steps)
    if (!step.empty()) path += step + "/";
  return path + name;
}

struct ButtonColours {
  Colour background, text, edge;
};

ButtonColours colours_of(const Theme& theme, const ButtonLook& look, const Pressed& state) {
  if (!look.enabled) return {look.style == ButtonStyle::Flat ? 0 : theme.head, theme.text3, look.style == ButtonStyle::Flat ? 0 : theme.line};
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

void push_path(Editor& editor, const std::string& step) {
  editor.place.steps.push_back(step);
  ImGui::PushID(step.c_str());
}

void pop_path(Editor& editor) {
  editor.place.steps.pop_back();
  ImGui::PopID();
}

void begin_region(Editor& editor, Region region, const std::string& name, const Rect& rect, Colour background) {
  editor.place.region = region;
  if (region != Region::Dialog) editor.place.windows.push_back("##" + name);
  ImGui::SetNextWindowPos(im(rect.low));
  ImGui::SetNextWindowSize(im(rect.size()));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
  ImGui::PushStyleColor(ImGuiCol_WindowBg, background);
  // What appears takes no keyboard and closes no menu, but for a dialog.
  ImGui::Begin(("##" + name).c_str(), nullptr, kRegionFlags | (region == Region::Dialog ? 0 : ImGuiWindowFlags_NoFocusOnAppearing));
  ImGui::PopStyleColor();
  ImGui::PopStyleVar();
  // A new window goes behind the others; a dialog stands before them, and what it opens before itself.
  if (region == Region::Dialog && ImGui::IsWindowAppearing()) ImGui::BringWindowToDisplayFront(ImGui::GetCurrentWindow());
  push_path(editor, name);
}

void end_region(Editor& editor) {
  pop_path(editor);
  ImGui::End();
}

void register_widget(Editor& editor, const std::string& name, const Rect& rect, bool enabled) {
  const ImVec2 low = ImGui::GetWindowDrawList()->GetClipRectMin(), high = ImGui::GetWindowDrawList()->GetClipRectMax();
  const Rect visible = intersection(rect, {from_im(low), from_im(high)});
  if (!visible.empty()) editor.widgets.add({path_of(editor, name), editor.place.region, visible, enabled});
}

Pressed press_area(Editor& editor, const std::string& name, const Rect& rect, bool enabled) {
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
  register_widget(editor, name, rect, enabled);
  ImGui::SetCursorScreenPos(back);
  return pressed;
}

static ImFont* font_of_button(const Editor& editor, ButtonStyle style) {
  return style == ButtonStyle::Primary || style == ButtonStyle::Chosen ? editor.look.fonts.semibold : editor.look.fonts.regular;
}

float width_of_button(const Editor& editor, const ButtonLook& look) {
  const float words = look.label.empty() ? 0 : text_size(font_of_button(editor, look.style), look.label).x;
  const float icon = *look.icon ? editor.look.px(16) : 0;
  const float gap = words > 0 && icon > 0 ? editor.look.px(8) : 0;
  return std::round(words + icon + gap + 2 * editor.look.px(words > 0 ? 11 : 7));
}

bool button(Editor& editor, const std::string& name, const Rect& rect, const ButtonLook& look) {
  const Pressed pressed = press_area(editor, name, rect, look.enabled);
  const ButtonColours colours = colours_of(editor.look.theme, look, pressed);
  const float rounding = editor.look.px(4);
  if (colours.background) fill(rect, colours.background, rounding);
  if (colours.edge) outline(rect, colours.edge, rounding, editor.look.line());

  ImFont* font = font_of_button(editor, look.style);
  const float icon = *look.icon ? editor.look.px(16) : 0, gap = icon > 0 && !look.label.empty() ? editor.look.px(8) : 0;
  const float words = std::min(text_size(font, look.label).x, rect.width() - icon - gap - editor.look.px(8));
  float x = std::round(rect.centre().x - (icon + gap + words) / 2);
  if (icon > 0) put_icon(editor.look.fonts.regular, colours.text, Rect{{x, rect.low.y}, {x + icon, rect.high.y}}, look.icon);
  if (!look.label.empty()) put_text(editor, font, colours.text, Rect{{x + icon + gap, rect.low.y}, {x + icon + gap + words + 1, rect.high.y}}, look.label);
  return pressed.clicked;
}

bool operator_button(Editor& editor, std::string_view id, const Rect& rect, const std::string& label, ButtonStyle style) {
  const Operator* op = find_operator(editor, id);
  if (!op) return false;
  const std::string reason = why_not(editor, *op);
  const bool clicked = button(editor, std::string(id), rect, {op->icon, label, style, reason.empty()});
  if (ImGui::IsItemHovered()) operator_tooltip(editor, *op, rect);
  if (clicked) run(editor, *op);
  return clicked;
}

void operator_menu_item(Editor& editor, std::string_view id) {
  const Operator* op = find_operator(editor, id);
  if (!op) return;
  const auto chord = editor.keymap.chord_of(op->id, contexts(editor));
  const bool enabled = why_not(editor, *op).empty(), on = op->checked && op->checked(editor);
  const Look& look = editor.look;
  const std::vector<std::string> caps = chord ? key_caps(*chord) : std::vector<std::string>{};
  const float width = std::max(look.px(190), text_size(look.fonts.regular, op->label).x + look.px(34 + 28) + width_of_key_caps(editor, caps) + look.px(10));
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::PushID(op->id.c_str());
  const bool clicked = ImGui::Selectable("##item", false, enabled ? 0 : ImGuiSelectableFlags_Disabled, ImVec2(width, look.px(22)));
  ImGui::PopID();
  const float wide = std::max(width, ImGui::GetContentRegionAvail().x);
  const Rect rect{from_im(corner), {corner.x + wide, corner.y + look.px(22)}};
  register_widget(editor, op->label, rect, enabled);
  const Colour colour = enabled ? look.theme.text : look.theme.text3;
  put_icon(look.fonts.regular, enabled ? look.theme.text2 : look.theme.text3, Rect{{rect.low.x + look.px(6), rect.low.y}, {rect.low.x + look.px(26), rect.high.y}},
           on ? icon::kTick : op->icon);
  put_text(editor, look.fonts.regular, colour, Rect{{rect.low.x + look.px(34), rect.low.y}, {rect.high.x, rect.high.y}}, op->label);
  put_key_caps(editor, rect.high.x - look.px(8) - width_of_key_caps(editor, caps), rect.centre().y, caps);
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
    const Rect beside{{rect.low.x, rect.low.y}, {rect.high.x, rect.high.y}};
    operator_tooltip(editor, *op, beside);
  }
  if (clicked) run(editor, *op);
}

}  // namespace limber::editor
