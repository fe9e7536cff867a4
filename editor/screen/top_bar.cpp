// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the top bar: logo, menus, workspace tabs, project name and search field.
#include "core/project/history.h"
#include "editor/context/context.h"
#include "editor/context/menu_state.h"
#include "editor/context/open_project.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/screen.h"
#include "editor/context/start_screen_state.h"
#include "editor/screen/menus.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

// Draws the logo, an L-shaped bone with two joints.
void draw_logo(Ui& ui, const glm::vec2& corner) {
  const Look& look = ui.look;
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  const float s = look.scale;
  const ImVec2 bone[] = {im(corner + s * glm::vec2(3, 2.5f)),     im(corner + s * glm::vec2(3, 10)),
                         im(corner + s * glm::vec2(3.6f, 13.4f)), im(corner + s * glm::vec2(5.6f, 15.6f)),
                         im(corner + s * glm::vec2(9, 16.5f)),    im(corner + s * glm::vec2(16.5f, 16.5f))};
  canvas.AddPolyline(bone, 6, look.theme.accent_text, 0, 3.2f * s);
  canvas.AddCircleFilled(bone[0], 2.9f * s, look.theme.select, 24);
  canvas.AddCircleFilled(bone[5], 2.9f * s, look.theme.select, 24);
}

float draw_menus(Context& context, float x, const Rect& bar) {
  const Look& look = context.ui->look;
  for (const Menu& menu : menus()) {
    const float width = text_size(look.fonts.regular, menu.title).x + look.px(20);
    const Rect rect{{x, bar.low.y + look.px(5)}, {x + width, bar.high.y - look.px(5)}};
    const std::string popup = "menu " + menu.title;
    const bool open = ImGui::IsPopupOpen(popup.c_str());
    const Pressed pressed = press_area(context.ui, menu.title, rect);
    if (pressed.hovered || open) fill(rect, open ? look.theme.active : look.theme.hover, look.px(4));
    put_text(context.ui, look.fonts.regular, look.theme.text, rect, menu.title, Align::Centre);
    // A menu opens when the user presses its title, or points at its title while another menu is open.
    const bool from_neighbour = !open && !context.menus->open_menu.empty() && context.menus->open_menu != menu.title &&
                                rect.contains(context.ui->input.pointer);
    if (pressed.activated || from_neighbour) ImGui::OpenPopup(popup.c_str());
    ImGui::SetNextWindowPos({rect.low.x, bar.high.y});
    if (ImGui::BeginPopup(popup.c_str(), ImGuiWindowFlags_NoMove)) {
      context.menus->open_menu = menu.title;
      context.ui->place.region = Region::Popup;
      push_path(context.ui, menu.title);
      draw_menu(context, menu);
      pop_path(context.ui);
      context.ui->place.region = Region::TopBar;
      ImGui::EndPopup();
    } else if (context.menus->open_menu == menu.title && !open) {
      context.menus->open_menu.clear();
    }
    x = rect.high.x;
  }
  return x;
}

float draw_workspaces(Context& context, float x, const Rect& bar) {
  const Look& look = context.ui->look;
  constexpr const char* kIds[] = {"workspace.rig", "workspace.skin", "workspace.pose", "workspace.resample"};
  for (const char* id : kIds) {
    const Operator* op = find_operator(context.operators, id);
    const bool chosen = op->checked(context) && !context.start_screen->shown;
    ImFont* font = chosen ? look.fonts.semibold : look.fonts.regular;
    const float words = text_size(font, op->label).x, width = std::round(words + look.px(16 + 9 + 2 * 16));
    const Rect rect{{x, bar.low.y + look.px(4)}, {x + width, bar.high.y - look.px(4)}};
    const Pressed pressed = press_area(context.ui, op->label, rect);
    if (chosen) fill(rect, look.theme.accent, look.px(5));
    else if (pressed.hovered) fill(rect, look.theme.hover, look.px(5));
    const Colour colour = chosen ? look.theme.on_accent : look.theme.text2;
    put_icon(look.fonts.regular, colour, Rect{{x + look.px(16), rect.low.y}, {x + look.px(32), rect.high.y}}, op->icon);
    put_text(context.ui, font, colour, Rect{{x + look.px(41), rect.low.y}, {rect.high.x, rect.high.y}}, op->label);
    if (pressed.hovered) operator_tooltip(context, *op, rect);
    if (pressed.clicked) run(context, *op);
    x = rect.high.x + look.px(4);
  }
  return x;
}

// Draws the project's name in the top bar, between the x coordinates `left` and `right`.
void draw_project_name(Context& context, float left, float right, const Rect& bar) {
  const Look& look = context.ui->look;
  const bool open = context.document().volume || !context.project->path.empty();
  const std::string name = context.project->name.empty() ? (open ? "Untitled" : "No project") : context.project->name;
  if (open && context.history->unsaved()) {
    ImGui::GetWindowDrawList()->AddCircleFilled({right - look.px(4), bar.centre().y}, 3.6f * look.scale,
                                                look.theme.select, 24);
    right -= look.px(14);
  }
  put_text(context.ui, look.fonts.regular, look.theme.text2, Rect{{left, bar.low.y}, {right, bar.high.y}}, name,
           Align::Right);
}

float draw_search(Context& context, float right, const Rect& bar) {
  const Look& look = context.ui->look;
  const Operator* op = find_operator(context.operators, "search.commands");
  if (!op) return right;
  const float width = look.px(context.screen->layout.search_as_icon ? 30 : 220);
  const Rect rect{{right - width, bar.low.y + look.px(5)}, {right, bar.high.y - look.px(5)}};
  const Pressed pressed = press_area(context.ui, "Search", rect);
  if (context.screen->layout.search_as_icon) {
    if (pressed.hovered) fill(rect, look.theme.hover, look.px(4));
    put_icon(look.fonts.regular, look.theme.text, rect, icon::kSearch);
  } else {
    fill(rect, look.theme.field, look.px(4));
    outline(rect, look.theme.line2, look.px(4), look.line());
    put_icon(look.fonts.regular, look.theme.text2,
             Rect{{rect.low.x + look.px(10), rect.low.y}, {rect.low.x + look.px(26), rect.high.y}}, icon::kSearch);
    put_text(context.ui, look.fonts.regular, look.theme.text3,
             Rect{{rect.low.x + look.px(33), rect.low.y}, {rect.high.x - look.px(40), rect.high.y}}, "Search commands");
    const std::vector<std::string> caps = {"F3"};
    put_key_caps(context.ui, rect.high.x - look.px(10) - width_of_key_caps(context.ui, caps), rect.centre().y, caps);
  }
  if (pressed.hovered) operator_tooltip(context, *op, rect);
  if (pressed.clicked) run(context, *op);
  return rect.low.x - look.px(12);
}

}  // namespace

void draw_top_bar(Context& context) {
  const Look& look = context.ui->look;
  const Rect& bar = context.screen->layout.top_bar;
  begin_region(context.ui, Region::TopBar, "top", bar, look.theme.head);
  draw_logo(context.ui, bar.low + glm::vec2(look.px(11), look.px(8)));
  float x = draw_menus(context, bar.low.x + look.px(38), bar) + look.px(4);
  fill({{x, bar.low.y + look.px(9)}, {x + look.line(), bar.high.y - look.px(9)}}, look.theme.line2);
  x = draw_workspaces(context, x + look.px(5), bar);
  const float right = draw_search(context, bar.high.x - look.px(8), bar);
  draw_project_name(context, x + look.px(8), right, bar);
  end_region(context.ui);
}

}  // namespace limber::editor
