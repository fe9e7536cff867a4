// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the views with their overlays and popups, and finds what is under the pointer.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "editor/context/panels.h"
#include "editor/context/pointer_context.h"
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

void draw_picture(Editor& editor, const ViewPlace& place) {
  Views& views = *editor.views;
  const bool body = place.id == ViewId::Body;
  const unsigned other = body                              ? (views.body.other ? views.body.other->texture() : 0)
                         : slice_of(views, place.id).other ? slice_of(views, place.id).other->texture()
                                                           : 0;
  if (place.side_a) return blit_picture(other, place.rect);
  blit_picture(body ? views.body.picture->texture() : slice_of(views, place.id).picture->texture(), place.rect);
  if (!other || editor.layout.by_sides) return;
  ImGui::PushClipRect(im(place.rect.low), {wipe_line(editor, place.rect), place.rect.high.y}, true);
  blit_picture(other, place.rect);
  ImGui::PopClipRect();
}

// Lets the user drag the divider between sides A and B of a comparison.
//   least  smallest fraction of the width of `rect` that is left for each side
Pressed press_divider(Editor& editor, const std::string& name, float x, const Rect& rect, float least) {
  Comparison& comparison = editor.comparison;
  const float half = editor.look.px(4);
  const Pressed pressed = press_area(editor, name, {{x - half, rect.low.y}, {x + half, rect.high.y}});
  if (pressed.hovered || pressed.held) editor.cursor = Cursor::ResizeX;
  const bool drags =
      pressed.held && !pressed.activated && ImGui::GetIO().MouseClickedLastCount[ImGuiMouseButton_Left] < 2;
  if (drags)
    comparison.share =
        std::clamp((editor.input.pointer.x - rect.low.x) / std::max(1.0f, rect.width()), least, 1 - least);
  if (pressed.double_clicked) comparison.share = 0.5f;
  return pressed;
}

// Draws the divider in the gap between the views of a side-by-side comparison.
void draw_divider(Editor& editor, const Rect& a, const Rect& b) {
  const Look& look = editor.look;
  const Rect both{a.low, b.high};
  const float x = (a.high.x + b.low.x) / 2;
  const Pressed pressed = press_divider(editor, "divider", x, both, 0.2f);
  const Colour colour = pressed.hovered || pressed.held ? look.theme.accent : look.theme.void_;
  fill({{a.high.x, both.low.y}, {b.low.x, both.high.y}}, colour);
  const Rect grip{{x - look.px(8), std::round(both.centre().y) - look.px(20)},
                  {x + look.px(8), std::round(both.centre().y) + look.px(20)}};
  fill(grip, look.theme.view_plate, look.px(4));
  outline(grip, pressed.hovered || pressed.held ? colour : look.theme.view_text2, look.px(4), look.line());
  put_icon(look.fonts.small, look.theme.view_text, grip, icon::kWipe);
}

// Draws the line that divides a view between sides A and B of a comparison, with the names of both results. In a low
// view, only the letters A and B are drawn, because the names would cover too much of the picture.
void draw_wipe(Editor& editor, const Rect& rect) {
  if (!editor.views->other_scene || editor.layout.by_sides) return;
  const Look& look = editor.look;
  Comparison& comparison = editor.comparison;
  const float x = wipe_line(editor, rect),
              y = std::round(rect.high.y - look.px(rect.height() > look.px(260) ? 72 : 34));
  const Pressed pressed = press_divider(editor, "wipe", x, rect, 0.02f);
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
    put_text(editor, look.fonts.regular, look.theme.view_text,
             Rect{{place.low.x + look.px(32), place.low.y}, {place.high.x - look.px(9), place.high.y}}, text);
  };
  chip("A", name_of_side(editor, comparison.a), true);
  chip("B", name_of_side(editor, comparison.b), false);
}

void hover_body(Editor& editor, const ViewPlace& place) {
  Hover& hover = editor.views->hover;
  const auto hit = body_at_pointer(editor, place).pick(glm::ivec2(editor.input.pointer - place.rect.low));
  if (!hit) return;
  hover.inside = true;
  hover.label = hit->label;
  hover.voxel = hit->voxel;
  hover.point = hit->point;
}

void hover_slice(Editor& editor, const ViewPlace& place) {
  Hover& hover = editor.views->hover;
  hover.point =
      world_of(slice_of(*editor.views, place.id).camera, editor.input.pointer - place.rect.low, place.rect.size());
  const render::Scene& scene = scene_at_pointer(editor, place);  // scene of the result that is shown at the pointer
  const auto voxel = voxel_shown_at(scene, hover.point);
  if (!voxel) return;
  hover.voxel = *voxel;
  hover.label = scene.volume->at_or_air(hover.voxel);
  hover.inside = hover.label != 0;
}

// Returns the title of the context menu for the selected bones: the name of a single bone, or the number of bones.
std::string title_of_bones(const Editor& editor) {
  const std::size_t count = editor.selection.bones.size();
  return count == 1 ? editor.document().armature->bones[*editor.selection.bones.begin()].name
                    : std::to_string(count) + " bones";
}

void draw_pointer_menu(Editor& editor) {
  if (!editor.open_popup.empty()) {
    ImGui::OpenPopup("pointer menu");
    editor.shown_popup = std::exchange(editor.open_popup, "");
  }
  if (!ImGui::BeginPopup("pointer menu", ImGuiWindowFlags_NoMove)) return editor.shown_popup.clear();
  editor.place.region = Region::Popup;
  const Menu menu = pointer_menu(editor.shown_popup, editor.views->active);
  const Tissue* tissue = editor.selection.tissue && editor.document().tissues
                             ? editor.document().tissues->find(*editor.selection.tissue)
                             : nullptr;
  std::string title =
      tissue && (editor.shown_popup == "context" || editor.shown_popup == "Tissue") ? shown_name(*tissue) : menu.title;
  if (menu.title == "Bone" && !editor.selection.bones.empty()) title = title_of_bones(editor);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  put_text(editor, editor.look.fonts.semibold, editor.look.theme.text2,
           from_im(corner) + glm::vec2(editor.look.px(8), editor.look.px(2)), title);
  ImGui::Dummy({text_size(editor.look.fonts.semibold, title).x + editor.look.px(16), editor.look.px(22)});
  ImGui::Separator();
  push_path(editor, editor.shown_popup);
  draw_menu(editor, menu);
  pop_path(editor);
  editor.place.region = Region::Views;
  ImGui::EndPopup();
}

// Draws a row of the pick list, which lists the bones and tissues under the pointer. The row has a colour swatch at the
// left and the text `right` at its right end. Returns true if the user clicked the row.
template <class Swatch>
bool pick_row(Editor& editor, const std::string& key, const std::string& name, const std::string& right, bool chosen,
              const Swatch& draw_swatch) {
  const Look& look = editor.look;
  const glm::vec2 corner = from_im(ImGui::GetCursorScreenPos());
  const Rect rect{corner, corner + glm::vec2(look.px(200), look.px(24))};
  const Pressed pressed = press_area(editor, key, rect);
  ImGui::Dummy(im(rect.size()));
  if (pressed.hovered || chosen) fill(rect, pressed.hovered ? look.theme.hover : look.theme.accent_soft, look.px(4));
  const float side = look.px(14), y = std::round(rect.centre().y - side / 2);
  draw_swatch(Rect{{rect.low.x + look.px(8), y}, {rect.low.x + look.px(8) + side, y + side}});
  put_text(editor, look.fonts.regular, look.theme.text,
           Rect{{rect.low.x + look.px(30), rect.low.y}, {rect.high.x - look.px(44), rect.high.y}}, name);
  put_text(editor, look.fonts.mono, look.theme.text2, Rect{rect.low, {rect.high.x - look.px(8), rect.high.y}}, right,
           Align::Right);
  if (pressed.clicked) ImGui::CloseCurrentPopup();
  return pressed.clicked;
}

// Draws the pick list, a popup that lists the bones and tissues under the pointer, nearest first.
void draw_pick_list(Editor& editor) {
  if (editor.open_pick_list) {
    ImGui::OpenPopup("pick list");
    editor.open_pick_list = false;
  }
  if (!ImGui::BeginPopup("pick list", ImGuiWindowFlags_NoMove)) return;
  const Look& look = editor.look;
  const Document& document = editor.document();
  editor.place.region = Region::Popup;
  push_path(editor, "pick");
  for (const Pickable& thing : editor.pick_list) {
    if (thing.bone) {
      if (!document.armature || *thing.bone >= std::ssize(document.armature->bones)) continue;
      const std::string& name = document.armature->bones[*thing.bone].name;
      const bool chosen = editor.selection.bones.contains(*thing.bone);
      if (pick_row(editor, "bone " + name, name, "bone", chosen,
                   [&](const Rect& rect) { put_bone_icon(look, rect, chosen ? look.theme.select : look.theme.text2); }))
        choose_bone(editor, *thing.bone);
    } else if (const Tissue* tissue = document.tissues->find(thing.tissue)) {
      const auto swatch = [&](const Rect& rect) {
        fill(rect, rgb(tissue->colour.r, tissue->colour.g, tissue->colour.b), look.px(3));
        outline(rect, look.theme.line2, look.px(3), look.line());
      };
      if (pick_row(editor, tissue->name, shown_name(*tissue), std::to_string(thing.tissue),
                   editor.selection.tissue == thing.tissue, swatch))
        select_tissue(editor, thing.tissue, false);
    }
  }
  pop_path(editor);
  editor.place.region = Region::Views;
  ImGui::EndPopup();
}

}  // namespace

void hover_views(Editor& editor) {
  Hover& hover = editor.views->hover;
  hover = {};
  const ViewPlace* place = hovered_view(editor);
  if (!place) return;
  hover.view = place->id;
  if (!editor.document().volume || editor.drag) return;
  if (place->id == ViewId::Body) hover_body(editor, *place);
  else hover_slice(editor, *place);
  if (hover.inside && is_of_document(editor, scene_at_pointer(editor, *place).volume))
    hover.weights = weights_at(*editor.views, editor.document(), hover.voxel);
}

void put_swatch(const Look& look, const glm::vec2& corner, Colour colour) {
  const glm::vec2 low = glm::round(corner);
  fill({low, low + look.px(14)}, colour, look.px(3));
}

void draw_side_chip(Editor& editor, const ViewPlace& place) {
  const Look& look = editor.look;
  const std::string& name = place.side_a ? editor.comparison.a : editor.comparison.b;
  const auto result = result_named(editor.document(), name);
  const std::string letter = place.side_a ? "A" : "B";
  std::string title = name_of_side(editor, name);
  char words[64] = "";
  if (const auto facts = result ? facts_of(editor, result) : nullptr; facts && facts->seconds > 0)
    std::snprintf(words, sizeof words, facts->seconds < 10 ? "%.1f s" : "%.0f s", facts->seconds);
  const float high = look.px(26), text_left = look.px(54),
              seconds = *words ? text_size(look.fonts.regular, words).x + look.px(10) : 0;
  // Width available for the title, px. In the view of side B, some width is left free for the axis ball.
  const float room = place.rect.width() - look.px(24) - (place.side_a ? 0 : look.px(100));
  if (result && text_left + text_size(look.fonts.semibold, title).x + look.px(12) > room)
    title = method_name(result->method);
  const float width = std::min(text_left + text_size(look.fonts.semibold, title).x + seconds + look.px(12), room);
  if (width < look.px(80)) return;
  const glm::vec2 low = place.rect.low + glm::vec2(look.px(12), look.px(10));
  const Rect chip{low, low + glm::vec2(width, high)};
  fill(chip, with_alpha(look.theme.view_plate, 0.85f), look.px(5));
  put_swatch(look, {chip.low.x + look.px(10), chip.centre().y - look.px(7)}, place.side_a ? kColourOfA : kColourOfB);
  put_text(editor, look.fonts.semibold, look.theme.view_text,
           Rect{{chip.low.x + look.px(34), chip.low.y}, {chip.low.x + text_left, chip.high.y}}, letter);
  const bool short_of_room = width < text_left + text_size(look.fonts.semibold, title).x + seconds + look.px(12);
  put_text(editor, look.fonts.semibold, look.theme.view_text,
           Rect{{chip.low.x + text_left, chip.low.y},
                {chip.high.x - look.px(10) - (short_of_room ? 0 : seconds), chip.high.y}},
           title);
  if (!short_of_room && *words)
    put_text(editor, look.fonts.regular, look.theme.view_text2,
             Rect{{chip.high.x - seconds - look.px(10), chip.low.y}, {chip.high.x - look.px(10), chip.high.y}}, words,
             Align::Right);
}

// Draws a text with a dark rim, so that it can be read over a bright body, too.
static void put_rimmed_text(Editor& editor, ImFont* font, Colour colour, const glm::vec2& corner,
                            const std::string& text) {
  const float rim = std::max(1.0f, std::floor(editor.look.scale));
  for (const glm::vec2& side : {glm::vec2(-1, 0), {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, 1}, {-1, 1}, {1, -1}})
    ImGui::GetWindowDrawList()->AddText(font, font->FontSize, im(corner + rim * side),
                                        with_alpha(editor.look.theme.view_bottom, 0.5f), text.c_str());
  put_text(editor, font, colour, corner, text);
}

void draw_view_title(Editor& editor, const Rect& rect, const std::string& title, const std::string& state) {
  const Look& look = editor.look;
  const glm::vec2 corner = rect.low + glm::vec2(look.px(12), look.px(10));
  put_rimmed_text(editor, look.fonts.regular, look.theme.view_text, corner, title);
  put_rimmed_text(editor, look.fonts.small, look.theme.view_text2, corner + glm::vec2(0, look.px(18)), state);
}

void draw_scale_bar(Editor& editor, const Rect& rect, double millimetres_per_pixel) {
  if (!editor.views->scale_bar || millimetres_per_pixel <= 0) return;
  const Look& look = editor.look;
  // Find a round length whose bar is 60 to 120 px long: 1, 2, 4, 5, 10, 15 or 20 mm, cm or m, or 1 to 400 micrometres.
  const double low = look.px(60) * millimetres_per_pixel, high = look.px(120) * millimetres_per_pixel;
  constexpr std::pair<double, const char*> kUnits[] = {{0.001, "\u00b5m"}, {1, "mm"}, {10, "cm"}, {1000, "m"}};
  double length = 0, number = 0;
  const char* unit = "";
  for (const auto& [millimetres, name] : kUnits)
    for (const double count : {1.0, 2.0, 4.0, 5.0, 10.0, 15.0, 20.0, 40.0, 50.0, 100.0, 200.0, 400.0})
      if (length == 0 && (count <= 20 || millimetres == 0.001) && count * millimetres >= low &&
          count * millimetres <= high) {
        length = count * millimetres;
        number = count;
        unit = name;
      }
  if (length == 0) return;
  const float pixels = std::round(static_cast<float>(length / millimetres_per_pixel)),
              right = rect.high.x - look.px(28), y = rect.high.y - look.px(26);
  if (rect.width() < pixels + look.px(120)) return;
  const Rect plate{{right - pixels - look.px(6), y - look.px(20)}, {right + look.px(6), y + look.px(8)}};
  fill(plate, with_alpha(look.theme.view_plate, 0.5f), look.px(4));
  register_widget(editor, "scale bar", plate);
  const float line = look.line(), tick = look.px(5);
  for (const Rect& stroke : {Rect{{right - pixels, y}, {right, y + 2 * line}},
                             Rect{{right - pixels, y - tick}, {right - pixels + 2 * line, y}},
                             Rect{{right - 2 * line, y - tick}, {right, y}}})
    fill(stroke, look.theme.view_text);
  put_text(editor, look.fonts.small, look.theme.view_text,
           Rect{{right - pixels, y - look.px(20)}, {right, y - look.px(2)}},
           std::to_string(static_cast<int>(number)) + " " + unit, Align::Centre);
}

void draw_empty_view(Editor& editor, const Rect& rect) {
  const Operator* open = find_operator(editor, "file.open");
  if (!open) {
    put_text(editor, editor.look.fonts.regular, editor.look.theme.view_text2, rect, "Drop a volume here",
             Align::Centre);
    return;
  }
  // A view is dark in every theme, so its text has the colours of views, not those of panels.
  const Look& look = editor.look;
  const glm::vec2 middle = rect.centre();
  put_text(editor, look.fonts.regular, look.theme.view_text2,
           Rect{{rect.low.x, middle.y - look.px(28)}, {rect.high.x, middle.y - look.px(8)}}, "Drop a volume here",
           Align::Centre);
  const ButtonLook face{"", "Open...", ButtonStyle::Plain};
  const glm::vec2 size{width_of_button(editor, face), look.px(26)},
      corner = glm::round(glm::vec2(middle.x - size.x / 2, middle.y));
  if (button(editor, "Open...", {corner, corner + size}, face)) run(editor, *open);
}

void draw_views_region(Editor& editor) {
  const Look& look = editor.look;
  begin_region(editor, Region::Views, "views", editor.layout.views, look.theme.void_);
  for (const ViewPlace& place : editor.layout.view_places) {
    const PathScope path(editor, name_of(place.id) + (place.side_a ? " A" : ""));
    register_widget(editor, "view", place.rect);
    draw_picture(editor, place);
    ImGui::PushClipRect(im(place.rect.low), im(place.rect.high), true);
    if (place.id == ViewId::Body) draw_body_overlay(editor, place);
    else draw_slice_overlay(editor, place);
    draw_seams(editor, place);
    draw_measurements_over(editor, place);
    draw_gizmo(editor, place);
    draw_brush(editor, place);
    draw_wipe(editor, place.rect);
    if (editor.layout.several() && place.id == editor.views->active)
      outline(place.rect, look.theme.accent, 0, 2 * look.line());
    ImGui::PopClipRect();
  }
  for (std::size_t i = 0; editor.layout.by_sides && i + 1 < editor.layout.view_places.size(); i += 2) {
    const ViewPlace &b = editor.layout.view_places[i], &a = editor.layout.view_places[i + 1];
    const PathScope path(editor, name_of(b.id));
    draw_divider(editor, a.rect, b.rect);
  }
  draw_weights_at_pointer(editor);
  draw_pointer_menu(editor);
  draw_pick_list(editor);
  draw_last_operation_popup(editor);
  end_region(editor);
}

}  // namespace limber::editor
