// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the views with their overlays and popups, and finds what is under the pointer.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "editor/context/comparison.h"
#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/context/panels.h"
#include "editor/context/pick_list.h"
#include "editor/context/pointer_context.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/context/window_state.h"
#include "editor/dialogs/redo_last_operator.h"
#include "editor/measure/measure_overlay.h"
#include "editor/resample/results.h"
#include "editor/screen/menus.h"
#include "editor/seams/seam_view.h"
#include "editor/selection/transform_gizmo.h"
#include "editor/shown/compare_wipe.h"
#include "editor/skin/paint_mode.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/icons.h"
#include "editor/ui/picture_blit.h"
#include "editor/volume/tissue_edits.h"

namespace limber::editor {

namespace {

void draw_picture(Context& context, const ViewPlace& place) {
  Views& views = *context.views;
  const bool body = place.id == ViewId::Body;
  const unsigned other = body                              ? (views.body.other ? views.body.other->texture() : 0)
                         : slice_of(views, place.id).other ? slice_of(views, place.id).other->texture()
                                                           : 0;
  if (place.side_a) return blit_picture(other, place.rect);
  const render::View3D& seen = views.body.shows_refined ? *views.body.refined : *views.body.picture;
  blit_picture(body ? seen.texture() : slice_of(views, place.id).picture->texture(), place.rect);
  if (!other || context.screen->layout.by_sides) return;
  ImGui::PushClipRect(im(place.rect.low), {wipe_line(context.comparison, place.rect), place.rect.high.y}, true);
  blit_picture(other, place.rect);
  ImGui::PopClipRect();
}

// Lets the user drag the divider between results A and B of a comparison.
//   least  smallest fraction of the width of `rect` that is left for each side
Pressed press_divider(Context& context, const std::string& name, float x, const Rect& rect, float least) {
  Comparison& comparison = context.comparison;
  const float half = context.ui->look.px(4);
  const Pressed pressed = press_area(context.ui, name, {{x - half, rect.low.y}, {x + half, rect.high.y}});
  if (pressed.hovered || pressed.held) context.window->cursor = Cursor::ResizeX;
  const bool drags =
      pressed.held && !pressed.activated && ImGui::GetIO().MouseClickedLastCount[ImGuiMouseButton_Left] < 2;
  if (drags)
    comparison.share =
        std::clamp((context.ui->input.pointer.x - rect.low.x) / std::max(1.0f, rect.width()), least, 1 - least);
  if (pressed.double_clicked) comparison.share = 0.5f;
  return pressed;
}

// Draws the divider in the gap between the views of a side-by-side comparison.
void draw_divider(Context& context, const Rect& a, const Rect& b) {
  const Look& look = context.ui->look;
  const Rect both{a.low, b.high};
  const float x = (a.high.x + b.low.x) / 2;
  const Pressed pressed = press_divider(context, "divider", x, both, 0.2f);
  const Colour colour = pressed.hovered || pressed.held ? look.theme.accent : look.theme.void_;
  fill({{a.high.x, both.low.y}, {b.low.x, both.high.y}}, colour);
  const Rect grip{{x - look.px(8), std::round(both.centre().y) - look.px(20)},
                  {x + look.px(8), std::round(both.centre().y) + look.px(20)}};
  fill(grip, look.theme.view_plate, look.px(4));
  outline(grip, pressed.hovered || pressed.held ? colour : look.theme.view_text2, look.px(4), look.line());
  put_icon(look.fonts.small, look.theme.view_text, grip, icon::kWipe);
}

// Draws the line that divides a view between results A and B of a comparison, with the names of both results. In a low
// view, only the letters A and B are drawn, because the names would cover too much of the picture.
void draw_wipe(Context& context, const Rect& rect) {
  if (!context.views->other_scene || context.screen->layout.by_sides) return;
  const Look& look = context.ui->look;
  Comparison& comparison = context.comparison;
  const float x = wipe_line(context.comparison, rect),
              y = std::round(rect.high.y - look.px(rect.height() > look.px(260) ? 72 : 34));
  const Pressed pressed = press_divider(context, "wipe", x, rect, 0.02f);
  const Colour colour = pressed.hovered || pressed.held ? look.theme.accent : look.theme.view_text;
  fill({{x - look.line(), rect.low.y}, {x + look.line(), rect.high.y}}, colour);
  const Rect grip{{x - look.px(9), y - look.px(16)}, {x + look.px(9), y + look.px(16)}};
  fill(grip, look.theme.view_plate, look.px(4));
  outline(grip, colour, look.px(4), look.line());
  put_icon(look.fonts.small, look.theme.view_text, grip, icon::kWipe);
  const bool roomy = rect.height() > look.px(260);
  const auto chip = [&](const std::string& letter, const std::string& name, bool left) {
    const std::string text = roomy ? letter + "  " + name : letter;
    const float width = std::min(text_size(look.fonts.regular, text).x + look.px(42),
                                 (left ? x - rect.low.x : rect.high.x - x) - look.px(32));
    if (width < look.px(roomy ? 60 : 40)) return;
    const Rect place = left ? Rect{{x - look.px(16) - width, y - look.px(13)}, {x - look.px(16), y + look.px(13)}}
                            : Rect{{x + look.px(16), y - look.px(13)}, {x + look.px(16) + width, y + look.px(13)}};
    fill(place, with_alpha(look.theme.view_plate, 0.85f), look.px(5));
    put_swatch(look, {place.low.x + look.px(10), place.centre().y - look.px(7)}, left ? kColourOfA : kColourOfB);
    put_text(context.ui, look.fonts.regular, look.theme.view_text,
             Rect{{place.low.x + look.px(32), place.low.y}, {place.high.x - look.px(9), place.high.y}}, text);
  };
  chip("A", name_of_side(context.document(), comparison.a), true);
  chip("B", name_of_side(context.document(), comparison.b), false);
}

void hover_body(Context& context, const ViewPlace& place) {
  Hover& hover = context.views->hover;
  const auto hit = pick_body(context, place, glm::ivec2(context.ui->input.pointer - place.rect.low));
  if (!hit) return;
  hover.inside = true;
  hover.label = hit->label;
  hover.voxel = hit->voxel;
  hover.point = hit->point;
}

void hover_slice(Context& context, const ViewPlace& place) {
  Hover& hover = context.views->hover;
  hover.point = world_of(slice_of(*context.views, place.id).camera, context.ui->input.pointer - place.rect.low,
                         place.rect.size());
  const render::Scene& scene = scene_at_pointer(context, place);  // scene of the result that is shown at the pointer
  const auto voxel = voxel_shown_at(scene, hover.point);
  if (!voxel) return;
  hover.voxel = *voxel;
  const auto& refined = context.views->refined_scene;
  const auto posed = refined ? voxel_shown_at(*refined, hover.point) : std::nullopt;
  hover.label = posed ? refined->volume->at_or_air(*posed) : scene.volume->at_or_air(hover.voxel);
  hover.inside = hover.label != 0;
}

// Returns the title of the context menu for the selected bones: the name of a single bone, or the number of bones.
std::string title_of_bones(const Context& context) {
  const std::size_t count = context.selection->bones.size();
  return count == 1 ? context.document().armature->bones[*context.selection->bones.begin()].name
                    : std::to_string(count) + " bones";
}

void draw_pointer_menu(Context& context) {
  if (!context.menus->open_popup.empty()) {
    ImGui::OpenPopup("pointer menu");
    context.menus->shown_popup = std::exchange(context.menus->open_popup, "");
  }
  if (!ImGui::BeginPopup("pointer menu", ImGuiWindowFlags_NoMove)) return context.menus->shown_popup.clear();
  context.ui->place.region = Region::Popup;
  const Menu menu = pointer_menu(context.menus->shown_popup, context.views->active);
  const Tissue* tissue = context.selection->tissue && context.document().tissues
                             ? context.document().tissues->find(*context.selection->tissue)
                             : nullptr;
  std::string title = tissue && (context.menus->shown_popup == "context" || context.menus->shown_popup == "Tissue")
                          ? shown_name(*tissue)
                          : menu.title;
  if (menu.title == "Bone" && !context.selection->bones.empty()) title = title_of_bones(context);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  put_text(context.ui, context.ui->look.fonts.semibold, context.ui->look.theme.text2,
           from_im(corner) + glm::vec2(context.ui->look.px(8), context.ui->look.px(2)), title);
  ImGui::Dummy(
      {text_size(context.ui->look.fonts.semibold, title).x + context.ui->look.px(16), context.ui->look.px(22)});
  ImGui::Separator();
  push_path(context.ui, context.menus->shown_popup);
  draw_menu(context, menu);
  pop_path(context.ui);
  context.ui->place.region = Region::Views;
  ImGui::EndPopup();
}

// Draws a row of the pick list, which lists the bones and tissues under the pointer. The row has a colour swatch at the
// left and the text `right` at its right end. Returns true if the user clicked the row.
template <class Swatch>
bool pick_row(Ui& ui, const std::string& key, const std::string& name, const std::string& right, bool chosen,
              const Swatch& draw_swatch) {
  const Look& look = ui.look;
  const glm::vec2 corner = from_im(ImGui::GetCursorScreenPos());
  const Rect rect{corner, corner + glm::vec2(look.px(200), look.px(24))};
  const Pressed pressed = press_area(ui, key, rect);
  ImGui::Dummy(im(rect.size()));
  if (pressed.hovered || chosen) fill(rect, pressed.hovered ? look.theme.hover : look.theme.accent_soft, look.px(4));
  const float side = look.px(14), y = std::round(rect.centre().y - side / 2);
  draw_swatch(Rect{{rect.low.x + look.px(8), y}, {rect.low.x + look.px(8) + side, y + side}});
  put_text(ui, look.fonts.regular, look.theme.text,
           Rect{{rect.low.x + look.px(30), rect.low.y}, {rect.high.x - look.px(44), rect.high.y}}, name);
  put_text(ui, look.fonts.mono, look.theme.text2, Rect{rect.low, {rect.high.x - look.px(8), rect.high.y}}, right,
           Align::Right);
  if (pressed.clicked) ImGui::CloseCurrentPopup();
  return pressed.clicked;
}

// Draws the pick list, a popup that lists the bones and tissues under the pointer, nearest first.
void draw_pick_list(Context& context) {
  if (context.pick_list->opens) {
    ImGui::OpenPopup("pick list");
    context.pick_list->opens = false;
  }
  if (!ImGui::BeginPopup("pick list", ImGuiWindowFlags_NoMove)) return;
  const Look& look = context.ui->look;
  const Document& document = context.document();
  context.ui->place.region = Region::Popup;
  push_path(context.ui, "pick");
  for (const Pickable& thing : context.pick_list->rows) {
    if (thing.bone) {
      if (!document.armature || *thing.bone >= std::ssize(document.armature->bones)) continue;
      const std::string& name = document.armature->bones[*thing.bone].name;
      const bool chosen = context.selection->bones.contains(*thing.bone);
      if (pick_row(context.ui, "bone " + name, name, "bone", chosen,
                   [&](const Rect& rect) { put_bone_icon(look, rect, chosen ? look.theme.select : look.theme.text2); }))
        choose_bone(context, *thing.bone);
    } else if (const Tissue* tissue = document.tissues->find(thing.tissue)) {
      const auto swatch = [&](const Rect& rect) {
        fill(rect, rgb(tissue->colour.r, tissue->colour.g, tissue->colour.b), look.px(3));
        outline(rect, look.theme.line2, look.px(3), look.line());
      };
      if (pick_row(context.ui, tissue->name, shown_name(*tissue), std::to_string(thing.tissue),
                   context.selection->tissue == thing.tissue, swatch))
        select_tissue(context, thing.tissue, false);
    }
  }
  pop_path(context.ui);
  context.ui->place.region = Region::Views;
  ImGui::EndPopup();
}

}  // namespace

void hover_views(Context& context) {
  Hover& hover = context.views->hover;
  hover = {};
  const ViewPlace* place = hovered_view(context);
  if (!place) return;
  hover.view = place->id;
  if (!context.document().volume || context.interaction->drag) return;
  if (place->id == ViewId::Body) hover_body(context, *place);
  else hover_slice(context, *place);
  if (hover.inside && is_of_document(context, scene_at_pointer(context, *place).volume))
    hover.weights = weights_at(*context.views, context.document(), hover.voxel);
}

void put_swatch(const Look& look, const glm::vec2& corner, Colour colour) {
  const glm::vec2 low = glm::round(corner);
  fill({low, low + look.px(14)}, colour, look.px(3));
}

void draw_side_chip(Context& context, const ViewPlace& place) {
  const Look& look = context.ui->look;
  const std::string& name = place.side_a ? context.comparison->a : context.comparison->b;
  const auto result = result_named(context.document(), name);
  const std::string letter = place.side_a ? "A" : "B";
  std::string title = name_of_side(context.document(), name);
  char words[64] = "";
  if (const auto facts = result ? facts_of(context, result) : nullptr; facts && facts->seconds > 0)
    std::snprintf(words, sizeof words, facts->seconds < 10 ? "%.1f s" : "%.0f s", facts->seconds);
  const float high = look.px(26), text_left = look.px(54),
              seconds = *words ? text_size(look.fonts.regular, words).x + look.px(10) : 0;
  // Width available for the title, px. In the view of result B, some width is left free for the axis ball.
  const float room = place.rect.width() - look.px(24) - (place.side_a ? 0 : look.px(100));
  if (result && text_left + text_size(look.fonts.semibold, title).x + look.px(12) > room)
    title = method_name(result->method);
  const float width = std::min(text_left + text_size(look.fonts.semibold, title).x + seconds + look.px(12), room);
  if (width < look.px(80)) return;
  const glm::vec2 low = place.rect.low + glm::vec2(look.px(12), look.px(10));
  const Rect chip{low, low + glm::vec2(width, high)};
  fill(chip, with_alpha(look.theme.view_plate, 0.85f), look.px(5));
  put_swatch(look, {chip.low.x + look.px(10), chip.centre().y - look.px(7)}, place.side_a ? kColourOfA : kColourOfB);
  put_text(context.ui, look.fonts.semibold, look.theme.view_text,
           Rect{{chip.low.x + look.px(34), chip.low.y}, {chip.low.x + text_left, chip.high.y}}, letter);
  const bool short_of_room = width < text_left + text_size(look.fonts.semibold, title).x + seconds + look.px(12);
  put_text(context.ui, look.fonts.semibold, look.theme.view_text,
           Rect{{chip.low.x + text_left, chip.low.y},
                {chip.high.x - look.px(10) - (short_of_room ? 0 : seconds), chip.high.y}},
           title);
  if (!short_of_room && *words)
    put_text(context.ui, look.fonts.regular, look.theme.view_text2,
             Rect{{chip.high.x - seconds - look.px(10), chip.low.y}, {chip.high.x - look.px(10), chip.high.y}}, words,
             Align::Right);
}

// Draws a text with a dark rim, so that it can be read over a bright body, too.
static void put_rimmed_text(Ui& ui, ImFont* font, Colour colour, const glm::vec2& corner, const std::string& text) {
  const float rim = std::max(1.0f, std::floor(ui.look.scale));
  for (const glm::vec2& side : {glm::vec2(-1, 0), {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, 1}, {-1, 1}, {1, -1}})
    ImGui::GetWindowDrawList()->AddText(font, font->FontSize, im(corner + rim * side),
                                        with_alpha(ui.look.theme.view_bottom, 0.5f), text.c_str());
  put_text(ui, font, colour, corner, text);
}

void draw_view_title(Ui& ui, const Rect& rect, const std::string& title, const std::string& state) {
  const Look& look = ui.look;
  const glm::vec2 corner = rect.low + glm::vec2(look.px(12), look.px(10));
  put_rimmed_text(ui, look.fonts.regular, look.theme.view_text, corner, title);
  put_rimmed_text(ui, look.fonts.small, look.theme.view_text2, corner + glm::vec2(0, look.px(18)), state);
}

void draw_empty_view(Context& context, const Rect& rect) {
  const Operator* open = find_operator(context.operators, "file.open");
  if (!open) {
    put_text(context.ui, context.ui->look.fonts.regular, context.ui->look.theme.view_text2, rect, "Drop a volume here",
             Align::Centre);
    return;
  }
  // A view is dark in every theme, so its text has the colours of views, not those of panels.
  const Look& look = context.ui->look;
  const glm::vec2 middle = rect.centre();
  put_text(context.ui, look.fonts.regular, look.theme.view_text2,
           Rect{{rect.low.x, middle.y - look.px(28)}, {rect.high.x, middle.y - look.px(8)}}, "Drop a volume here",
           Align::Centre);
  const ButtonLook face{"", "Open...", ButtonStyle::Plain};
  const glm::vec2 size{width_of_button(context.ui, face), look.px(26)},
      corner = glm::round(glm::vec2(middle.x - size.x / 2, middle.y));
  if (button(context.ui, "Open...", {corner, corner + size}, face)) run(context, *open);
}

void draw_views_region(Context& context) {
  const Look& look = context.ui->look;
  begin_region(context.ui, Region::Views, "views", context.screen->layout.views, look.theme.void_);
  for (const ViewPlace& place : context.screen->layout.view_places) {
    const PathScope path(context.ui, name_of(place.id) + (place.side_a ? " A" : ""));
    register_widget(context.ui, "view", place.rect);
    draw_picture(context, place);
    ImGui::PushClipRect(im(place.rect.low), im(place.rect.high), true);
    if (place.id == ViewId::Body) draw_body_overlay(context, place);
    else draw_slice_overlay(context, place);
    draw_seams(context, place);
    draw_measurements_over(context, place);
    draw_gizmo(context, place);
    draw_brush(context, place);
    draw_wipe(context, place.rect);
    if (context.screen->layout.several() && place.id == context.views->active)
      outline(place.rect, look.theme.accent, 0, 2 * look.line());
    ImGui::PopClipRect();
  }
  for (std::size_t i = 0; context.screen->layout.by_sides && i + 1 < context.screen->layout.view_places.size();
       i += 2) {
    const ViewPlace &b = context.screen->layout.view_places[i], &a = context.screen->layout.view_places[i + 1];
    const PathScope path(context.ui, name_of(b.id));
    draw_divider(context, a.rect, b.rect);
  }
  draw_weights_at_pointer(context);
  draw_pointer_menu(context);
  draw_pick_list(context);
  draw_last_operation_popup(context);
  end_region(context.ui);
}

}  // namespace limber::editor
