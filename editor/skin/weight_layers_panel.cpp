// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the list of weight layers, the topmost layer first. A row has the layer's name and opacity, an eye that hides
// the layer, and a button that paints its mask. The last row is the base, which cannot be removed.
#include "editor/context/context.h"
#include "editor/context/operator.h"
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

void draw_eye(Context& context, const Rect& rect, std::size_t index, bool visible) {
  const Look& look = context.ui->look;
  const Pressed pressed = press_area(context.ui, "eye", rect);
  put_icon(look.fonts.regular, visible ? look.theme.text2 : look.theme.text3, rect,
           visible ? icon::kVisible : icon::kHidden);
  if (pressed.hovered)
    tooltip(context.ui, rect, visible ? "Hide layer" : "Show layer",
            "A layer affects the weights only while it is shown.");
  if (pressed.clicked) show_layer(context, index, !visible);
}

// Draws a layer's mask button, a half-filled square. The button has a frame while strokes paint this layer's mask.
void draw_mask(Context& context, const Rect& rect, std::size_t index, bool painted) {
  const Look& look = context.ui->look;
  const Pressed pressed = press_area(context.ui, "mask", rect);
  const glm::vec2 corner = glm::round(rect.centre() - glm::vec2(look.px(7)));
  const Rect swatch{corner, corner + look.px(14)};
  fill(swatch, look.theme.text3, look.px(3));
  fill({{swatch.centre().x, swatch.low.y}, swatch.high}, look.theme.text, look.px(3));
  if (painted || pressed.hovered)
    outline({swatch.low - look.px(2), swatch.high + look.px(2)}, painted ? look.theme.accent_text : look.theme.line2,
            look.px(4), 2 * look.line());
  if (pressed.hovered) operator_tooltip(context, *find_operator(context.operators, "skin.layer_mask"), rect);
  if (!pressed.clicked) return;
  choose_layer(context, index);
  context.skin->painting->mask = !painted;
}

void draw_layer(Context& context, Column& column, int row, std::size_t index, const WeightLayer& layer) {
  const Look& look = context.ui->look;
  const bool active = active_layer(context) == index;
  Rect rect;
  const std::string renamed = kList + std::to_string(index);
  if (is_renaming(context.ui, renamed) && !context.ui->renaming->shown) focus_list(context.ui, kList, row);
  if (!column.list_row(rect, row, active, kList)) return;
  const PathScope path(context.ui, "layer " + std::to_string(index));
  draw_eye(context, {{rect.low.x + look.px(6), rect.low.y}, {rect.low.x + look.px(26), rect.high.y}}, index,
           layer.visible);
  draw_mask(context, {{rect.low.x + look.px(28), rect.low.y}, {rect.low.x + look.px(48), rect.high.y}}, index,
            active && context.skin->painting->mask);
  const Rect name{{rect.low.x + look.px(54), rect.low.y}, {rect.high.x - look.px(kOpacity + 14), rect.high.y}};
  const Rect field{{rect.high.x - look.px(kOpacity + 8), rect.low.y + look.px(1)},
                   {rect.high.x - look.px(8), rect.high.y - look.px(1)}};
  // The name and the opacity are copied, because the fields below may commit an edit that replaces the layer.
  const std::string layer_name = layer.name;
  const double before = layer.opacity;
  double percent = 100 * before;
  bool committed = false;
  number_field(context.ui, "opacity", field, percent, 0, 100, "%.0f", "%", true, committed);
  if (is_renaming(context.ui, renamed)) {
    std::string accepted = layer_name;
    if (rename_field(context.ui, name, accepted)) rename_layer(context, index, accepted);
  } else {
    const Pressed pressed = press_area(context.ui, "name", name);
    put_text(context.ui, active ? look.fonts.semibold : look.fonts.regular,
             layer.visible ? look.theme.text
             : active      ? look.theme.text2
                           : look.theme.text3,
             name, layer_name);
    if (pressed.clicked) {
      focus_list(context.ui, kList, row);
      choose_layer(context, index);
    }
    if (pressed.double_clicked) begin_renaming(context.ui, renamed, layer_name);
  }
  if (committed) set_layer_opacity(context, index, percent / 100);
}

void draw_base(Context& context, Column& column, int row) {
  const Look& look = context.ui->look;
  const bool active = !active_layer(context);
  Rect rect;
  if (!column.list_row(rect, row, active, kList)) return;
  const Pressed pressed = press_area(context.ui, "base", rect);
  put_text(context.ui, active ? look.fonts.semibold : look.fonts.regular, look.theme.text,
           Rect{{rect.low.x + look.px(54), rect.low.y}, {rect.high.x - look.px(8), rect.high.y}}, "Base");
  if (!pressed.clicked) return;
  focus_list(context.ui, kList, row);
  choose_layer(context, std::nullopt);
}

void take_key(Context& context, int count) {
  const ListKey key = list_key(context.ui, kList, count + 1);
  if (key == ListKey::None) return;
  const int row = context.ui->list_focus.row;
  const std::optional<std::size_t> layer =
      row < count ? std::optional(static_cast<std::size_t>(count - 1 - row)) : std::nullopt;
  if (key == ListKey::Moved || key == ListKey::Activate) choose_layer(context, layer);
  if (key == ListKey::Toggle && layer) show_layer(context, *layer, !context.document().layers->layers[*layer]->visible);
  if (key == ListKey::Rename && layer)
    begin_renaming(context.ui, kList + std::to_string(*layer), context.document().layers->layers[*layer]->name);
}

void draw_foot(Context& context, Column& column) {
  const Look& look = context.ui->look;
  const Rect rect = column.row(38);
  float x = rect.low.x + look.px(10);
  const float y = rect.low.y + look.px(6);
  for (const char* id : {"skin.layer_add", "skin.layer_remove", "skin.layer_up", "skin.layer_down", "skin.layer_merge",
                         "skin.layer_mask"}) {
    const Operator* op = find_operator(context.operators, id);
    const bool on = op->checked && op->checked(context);
    operator_button(context, id, {{x, y}, {x + look.px(30), y + look.px(26)}}, "",
                    on ? ButtonStyle::Soft : ButtonStyle::Plain);
    x += look.px(36);
  }
}

}  // namespace

void draw_layers(Context& context, Column& column) {
  const auto layers = context.document().layers;  // a copy, because a row may commit an edit that replaces it
  const int count = layers ? static_cast<int>(layers->layers.size()) : 0;
  if (column.begin_section("Layers", count ? std::to_string(count) : "")) {
    take_key(context, count);
    for (int row = 0; row < count; ++row)
      draw_layer(context, column, row, static_cast<std::size_t>(count - 1 - row),
                 *layers->layers[static_cast<std::size_t>(count - 1 - row)]);
    draw_base(context, column, count);
    draw_foot(context, column);
  }
  column.end_section();
}

}  // namespace limber::editor
