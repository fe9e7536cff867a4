// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws over a view the legend of the finite element colours: the measure's colour scale, and the range of its values
// in this result.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/resample/fem_overlay.h"

namespace limber::editor {

namespace {

constexpr float kWidth = 322, kNarrow = 236, kHeight = 58, kMargin = 8, kNeeded = 360;
constexpr int kSteps = 64;  // number of rectangles of equal colour that make up the drawn colour scale

Colour colour(const glm::vec3& srgb) { return rgb(srgb.r, srgb.g, srgb.b); }

std::string tick_text(double value) {
  char text[16];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

}  // namespace

bool draw_fem_legend(Context& context, const Rect& view) {
  const MeasuredMesh* shown = shown_measure(context);
  if (!shown || view.width() < context.ui->look.px(kNeeded) || view.height() < context.ui->look.px(160)) return false;
  const Look& look = context.ui->look;
  const FemMeasure measure = *shown->measure;
  const FemScale& scale = scale_of(measure);
  const glm::vec2 low{view.low.x + look.px(kMargin), view.high.y - look.px(kMargin + kHeight)};
  const Rect box{
      low, low + glm::vec2(std::clamp(0.55f * view.width(), look.px(kNarrow), look.px(kWidth)), look.px(kHeight))};
  fill(box, with_alpha(look.theme.view_plate, 0.85f), look.px(5));
  const Pressed pressed = press_area(context.ui, "legend", box);
  if (pressed.hovered) operator_tooltip(context, *find_operator(context.operators, "fem.display_pie"), box);
  if (pressed.clicked) run(context, "fem.display_pie");

  const float left = box.low.x + look.px(10), right = box.high.x - look.px(10), top = box.low.y + look.px(26),
              bottom = top + look.px(12);
  const Rect head{{left, box.low.y + look.px(3)}, {right, box.low.y + look.px(23)}};
  const std::string title = scale.name + (scale.unit.empty() ? "" : ", " + scale.unit);
  put_text(context.ui, look.fonts.regular, look.theme.view_text, head, title);
  const std::string range = range_text(*shown);
  if (text_size(look.fonts.regular, title).x + text_size(look.fonts.small, range).x + look.px(12) < head.width())
    put_text(context.ui, look.fonts.small, look.theme.view_text2, head, range, Align::Right);
  const float width = (right - left) / kSteps;
  for (int step = 0; step < kSteps; ++step)
    fill({{left + width * float(step), top}, {left + width * float(step + 1), bottom}},
         colour(colour_at(measure, (step + 0.5) / kSteps)));
  for (const double tick : scale.ticks) {
    const float place = static_cast<float>(place_on(scale, tick)), x = std::round(left + (right - left) * place);
    fill({{std::min(x, right - look.line()), bottom},
          {std::min(x, right - look.line()) + look.line(), bottom + look.px(3)}},
         look.theme.view_text2);
    const std::string words = tick_text(tick);
    const float half = text_size(look.fonts.small, words).x / 2 + 1, middle = std::clamp(x, left + half, right - half);
    put_text(context.ui, look.fonts.small, look.theme.view_text2,
             Rect{{middle - half, bottom + look.px(2)}, {middle + half, box.high.y - look.px(1)}}, words,
             Align::Centre);
  }
  return true;
}

}  // namespace limber::editor
