// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the section "Measurements" of the sidebar: the tools, and the list with the values on the shown body.
#include <array>
#include <cmath>

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/views.h"
#include "editor/measure/measure_view.h"

namespace limber::editor {

namespace {

constexpr std::array<std::array<const char*, 2>, 2> kTools = {
    {{"measure.distance", "measure.angle"}, {"measure.girth", "measure.thickness"}}};

// Draws the buttons of two operators side by side over the width of a row.
void draw_buttons(Context& context, const Rect& row, const std::array<const char*, 2>& ids,
                  const std::array<const char*, 2>& labels) {
  const float middle = std::round(row.centre().x), gap = context.ui->look.px(3), side = context.ui->look.px(10);
  operator_button(context, ids[0], {{row.low.x + side, row.low.y}, {middle - gap, row.high.y}}, labels[0]);
  operator_button(context, ids[1], {{middle + gap, row.low.y}, {row.high.x - side, row.high.y}}, labels[1]);
}

void draw_list(Context& context, Column& column, const Measurements& all) {
  const Look& look = context.ui->look;
  const auto placed = placed_measurements(context, context.views->scene);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Measurement& one = all[i];
    Rect row;
    const bool is_chosen = one.name == context.measures->chosen;
    if (!column.list_row(row, static_cast<int>(i), is_chosen)) continue;
    const Pressed pressed = press_area(context.ui, one.name, row);
    const std::string value = text_of_measure(one.kind, measure(one.kind, placed[i]));
    const float width = text_size(look.fonts.mono, value).x;
    put_text(context.ui, look.fonts.regular, look.theme.text,
             Rect{{row.low.x + look.px(12), row.low.y}, {row.high.x - width - look.px(20), row.high.y}}, one.name);
    put_text(context.ui, look.fonts.mono, look.theme.text2, Rect{row.low, {row.high.x - look.px(10), row.high.y}},
             value, Align::Right);
    if (pressed.hovered)
      tooltip(context.ui, row, one.name, "At rest " + text_of_measure(one.kind, measure(one.kind, one.points)) + ".");
    if (pressed.clicked) {
      context.measures->chosen = one.name;
      // Move the slices to the middle of the measurement.
      glm::dvec3 sum(0);
      for (const glm::dvec3& point : placed[i]) sum += point;
      context.views->cross_hair = sum / double(placed[i].size());
    }
    if (pressed.double_clicked) run(context, "measure.rename");
  }
}

}  // namespace

void draw_measurements(Context& context, Column& column) {
  if (!context.document().volume) return;
  const auto& all = context.document().measurements;
  const std::size_t count = all ? all->size() : 0;
  if (column.begin_section("Measurements", count ? std::to_string(count) : "", false)) {
    column.space(4);
    draw_buttons(context, column.row(26), kTools[0], {"Distance", "Angle"});
    column.space(4);
    draw_buttons(context, column.row(26), kTools[1], {"Girth", "Thickness"});
    column.space(4);
    if (count) {
      draw_list(context, column, *all);
      column.space(4);
      draw_buttons(context, column.row(26), {"measure.delete", "measure.copy"}, {"Delete", "Copy as table"});
    }
    column.space(6);
  }
  column.end_section();
}

}  // namespace limber::editor
