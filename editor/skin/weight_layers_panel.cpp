// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the list of weight layers, the topmost layer first. A row has an eye that hides the layer, a button that paints
// its mask, its name and its opacity. The last row is the base, which cannot be removed.
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_layers.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/list_navigation.h"

namespace limber::editor {

namespace {

constexpr char kList[] = "layers";
constexpr float kOpacity = 58;

void draw_eye(Editor& editor, const Rect& rect, std::size_t index, bool visible) {
  const Look& look = editor.look;
  const Pressed pressed = press_area(editor, "eye", rect);
  put_icon(look.fonts.regular, visible ? look.theme.text2 : look.theme.text3, rect,
           visible ? icon::kVisible : icon::kHidden);
  if (pressed.hovered)
    tooltip(editor, rect, visible ? "Hide layer" : "Show layer", "A layer affects the weights only while it is shown.");
  if (pressed.clicked) show_layer(editor, index, !visible);
}

// Draws a layer's mask button, a half-filled square. The button has a frame while strokes paint this layer's mask.
void draw_mask(Editor& editor, const Rect& rect, std::size_t index, bool painted) {
  const Look& look = editor.look;
  const Pressed pressed = press_area(editor, "mask", rect);
  const glm::vec2 corner = glm::round(rect.centre() - glm::vec2(look.px(7)));
  const Rect swatch{corner, corner + look.px(14)};
  fill(swatch, look.theme.text3, look.px(3));
  fill({{swatch.centre().x, swatch.low.y}, swatch.high}, look.theme.text, look.px(3));
  if (painted || pressed.hovered)
    outline({swatch.low - look.px(2), swatch.high + look.px(2)}, painted ? look.theme.accent_text : look.theme.line2,
            look.px(4), 2 * look.line());
  if (pressed.hovered) operator_tooltip(editor, *find_operator(editor, "skin.layer_mask"), rect);
  if (!pressed.clicked) return;
  choose_layer(editor, index);
  editor.skin->painting->mask = !painted;
}

void draw_layer(Editor& editor, Column& column, int row, std::size_t index, const WeightLayer& layer) {
  const Look& look = editor.look;
  const bool active = active_layer(editor) == index;
  Rect rect;
  const std::string renamed = kList + std::to_string(index);
  if (is_renaming(editor, renamed) && !editor.renaming->shown) focus_list(editor, kList, row);
  if (!column.list_row(rect, row, active, kList)) return;
  const PathScope path(editor, "layer " + std::to_string(index));
  draw_eye(editor, {{rect.low.x + look.px(6), rect.low.y}, {rect.low.x + look.px(26), rect.high.y}}, index,
           layer.visible);
  draw_mask(editor, {{rect.low.x + look.px(28), rect.low.y}, {rect.low.x + look.px(48), rect.high.y}}, index,
            active && editor.skin->painting->mask);
  const Rect name{{rect.low.x + look.px(54), rect.low.y}, {rect.high.x - look.px(kOpacity + 14), rect.high.y}};
  const Rect field{{rect.high.x - look.px(kOpacity + 8), rect.low.y + look.px(1)},
                   {rect.high.x - look.px(8), rect.high.y - look.px(1)}};
  // The name and the opacity are copied, because the fields below may commit an edit that replaces the layer.
  const std::string layer_name = layer.name;
  const double before = layer.opacity;
  double percent = 100 * before;
  bool committed = false;
  number_field(editor, "opacity", field, percent, 0, 100, "%.0f", "%", true, committed);
  if (is_renaming(editor, renamed)) {
    std::string accepted = layer_name;
    if (rename_field(editor, name, accepted)) rename_layer(editor, index, accepted);
  } else {
    const Pressed pressed = press_area(editor, "name", name);
    put_text(editor, active ? look.fonts.semibold : look.fonts.regular,
             layer.visible ? look.theme.text
             : active      ? look.theme.text2
                           : look.theme.text3,
             name, layer_name);
    if (pressed.clicked) {
      focus_list(editor, kList, row);
      choose_layer(editor, index);
    }
    if (pressed.double_clicked) begin_renaming(editor, renamed, layer_name);
  }
  if (committed) set_layer_opacity(editor, index, percent / 100);
}

void draw_base(Editor& editor, Column& column, int row) {
  const Look& look = editor.look;
  const bool active = !active_layer(editor);
  Rect rect;
  if (!column.list_row(rect, row, active, kList)) return;
  const Pressed pressed = press_area(editor, "base", rect);
  put_text(editor, active ? look.fonts.semibold : look.fonts.regular, look.theme.text,
           Rect{{rect.low.x + look.px(54), rect.low.y}, {rect.high.x - look.px(8), rect.high.y}}, "Base");
  if (!pressed.clicked) return;
  focus_list(editor, kList, row);
  choose_layer(editor, std::nullopt);
}

void take_key(Editor& editor, int count) {
  const ListKey key = list_key(editor, kList, count + 1);
  if (key == ListKey::None) return;
  const int row = editor.list_focus.row;
  const std::optional<std::size_t> layer =
      row < count ? std::optional(static_cast<std::size_t>(count - 1 - row)) : std::nullopt;
  if (key == ListKey::Moved || key == ListKey::Activate) choose_layer(editor, layer);
  if (key == ListKey::Toggle && layer) show_layer(editor, *layer, !editor.document().layers->layers[*layer]->visible);
  if (key == ListKey::Rename && layer)
    begin_renaming(editor, kList + std::to_string(*layer), editor.document().layers->layers[*layer]->name);
}

void draw_foot(Editor& editor, Column& column) {
  const Look& look = editor.look;
  const Rect rect = column.row(38);
  float x = rect.low.x + look.px(10);
  const float y = rect.low.y + look.px(6);
  for (const char* id : {"skin.layer_add", "skin.layer_remove", "skin.layer_up", "skin.layer_down", "skin.layer_merge",
                         "skin.layer_mask"}) {
    const Operator* op = find_operator(editor, id);
    const bool on = op->checked && op->checked(editor);
    operator_button(editor, id, {{x, y}, {x + look.px(30), y + look.px(26)}}, "",
                    on ? ButtonStyle::Soft : ButtonStyle::Plain);
    x += look.px(36);
  }
}

}  // namespace

void draw_layers(Editor& editor, Column& column) {
  const auto layers = editor.document().layers;  // a copy, because a row may commit an edit that replaces it
  const int count = layers ? static_cast<int>(layers->layers.size()) : 0;
  if (column.begin_section("Layers", count ? std::to_string(count) : "")) {
    take_key(editor, count);
    for (int row = 0; row < count; ++row)
      draw_layer(editor, column, row, static_cast<std::size_t>(count - 1 - row),
                 *layers->layers[static_cast<std::size_t>(count - 1 - row)]);
    draw_base(editor, column, count);
    draw_foot(editor, column);
  }
  column.end_section();
}

}  // namespace limber::editor
