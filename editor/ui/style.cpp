// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/style.h"

#include <imgui.h>

#include "editor/ui/asset_path.h"

namespace limber::editor {

namespace {

void set_colours(const Theme& theme) {
  ImGui::StyleColorsDark();
  ImVec4* colours = ImGui::GetStyle().Colors;
  const auto set = [&](std::initializer_list<ImGuiCol> which, Colour colour) {
    for (const ImGuiCol index : which) colours[index] = ImGui::ColorConvertU32ToFloat4(colour);
  };
  set({ImGuiCol_WindowBg, ImGuiCol_ChildBg, ImGuiCol_PopupBg}, theme.panel);
  set({ImGuiCol_MenuBarBg, ImGuiCol_TitleBg, ImGuiCol_TitleBgActive, ImGuiCol_TableHeaderBg}, theme.head);
  set({ImGuiCol_Button}, theme.raised);
  set({ImGuiCol_ButtonHovered}, theme.hover);
  // In the light theme, rows of menus with the hover colour of buttons would hardly differ from the panel.
  set({ImGuiCol_ButtonActive, ImGuiCol_HeaderHovered, ImGuiCol_HeaderActive}, theme.active);
  set({ImGuiCol_Header, ImGuiCol_TextSelectedBg}, theme.accent_soft);
  set({ImGuiCol_FrameBg, ImGuiCol_FrameBgHovered, ImGuiCol_FrameBgActive}, theme.field);
  set({ImGuiCol_Separator, ImGuiCol_TableBorderLight}, theme.line);
  set({ImGuiCol_Border, ImGuiCol_TableBorderStrong}, theme.line2);
  set({ImGuiCol_BorderShadow}, 0);
  set({ImGuiCol_Text}, theme.text);
  set({ImGuiCol_TextDisabled}, theme.text3);
  set({ImGuiCol_CheckMark, ImGuiCol_SliderGrab, ImGuiCol_SliderGrabActive, ImGuiCol_NavHighlight,
       ImGuiCol_PlotHistogram},
      theme.accent);
  set({ImGuiCol_ScrollbarBg}, 0);
  set({ImGuiCol_ScrollbarGrab}, theme.line2);
  set({ImGuiCol_ScrollbarGrabHovered}, theme.text3);
  set({ImGuiCol_ScrollbarGrabActive}, theme.text2);
  set({ImGuiCol_ModalWindowDimBg}, with_alpha(0, 0.45f));
}

void set_sizes(const Look& look) {
  ImGuiStyle& style = ImGui::GetStyle();
  const auto px = [&](float size) { return look.px(size); };
  style.FramePadding = {px(7), px(3)};
  style.ItemSpacing = {px(8), px(4)};
  style.ItemInnerSpacing = {px(6), px(4)};
  style.WindowPadding = {px(6), px(6)};
  style.IndentSpacing = px(16);
  style.ScrollbarSize = px(10);
  style.GrabMinSize = px(10);
  style.WindowBorderSize = 0;
  style.PopupBorderSize = look.line();
  style.FrameBorderSize = look.line();
  style.ScrollbarRounding = px(4);
  style.FrameRounding = style.GrabRounding = px(4);
  style.PopupRounding = px(6);
  style.WindowRounding = style.ChildRounding = 0;
  style.WindowMinSize = {1, 1};
  style.DisabledAlpha = 1;
}

}  // namespace

bool apply_look(Look& look, const std::string& theme, float scale) {
  look.theme = read_theme(asset("themes/" + theme + ".json"));
  const bool other_scale = scale != look.scale;
  look.scale = scale;
  if (other_scale) look.fonts = build_fonts(scale);
  set_colours(look.theme);
  set_sizes(look);
  return other_scale;
}

}  // namespace limber::editor
