// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the scale bar at the lower right of a view. It is 60 to 120 px long, and shorter only in a view so narrow that
// it would reach the letter at the middle of the view's lower edge. While the scale bar is switched on, every view of a
// volume has one, at any zoom.
#include "editor/screen/scale_bar.h"

#include <algorithm>
#include <cmath>

#include "editor/context/context.h"
#include "editor/context/panels.h"
#include "editor/context/views.h"

namespace limber::editor {

namespace {

constexpr float kLeastLength = 60, kShortestLength = 16;  // px at scale 1
// Distances of the bar from the view's right edge and from the letter at the middle of its lower edge, px at scale 1.
constexpr float kRight = 28, kLetter = 22;

struct Unit {
  double millimetres;
  const char* name;
  double last;  // the largest count of this unit; longer lengths are told in the next unit
};
constexpr Unit kUnits[] = {{0.001, "\u00b5m", 500}, {1, "mm", 20}, {10, "cm", 50}, {1000, "m", 500}};
constexpr int kCounts[] = {1, 2, 4, 5, 10, 15, 20, 40, 50, 100, 200, 400, 500};

}  // namespace

ScaleLength scale_length(double least) {
  ScaleLength length;
  for (const Unit& unit : kUnits)
    for (const int count : kCounts) {
      if (count > unit.last) break;
      length = {count * unit.millimetres, std::to_string(count) + " " + unit.name};
      if (length.millimetres >= least) return length;
    }
  return length;
}

void draw_scale_bar(Context& context, const Rect& rect, double millimetres_per_pixel) {
  if (!context.views->scale_bar || millimetres_per_pixel <= 0) return;
  const Look& look = context.ui->look;
  const float room = rect.width() / 2 - look.px(kRight + kLetter);
  const float least = std::clamp(room / 2, look.px(kShortestLength), look.px(kLeastLength));
  const ScaleLength length = scale_length(least * millimetres_per_pixel);
  // The longest length of all is still too short for a bar when the view shows many kilometres.
  const float pixels =
      std::max(std::round(static_cast<float>(length.millimetres / millimetres_per_pixel)), look.line());
  const float right = rect.high.x - look.px(kRight), y = rect.high.y - look.px(26);
  const float text = std::ceil(text_size(look.fonts.small, length.text).x), width = std::max(pixels, text);
  const Rect plate{{right - width - look.px(6), y - look.px(20)}, {right + look.px(6), y + look.px(8)}};
  fill(plate, with_alpha(look.theme.view_plate, 0.5f), look.px(4));
  register_widget(context.ui, "scale bar", plate);
  const float line = look.line(), tick = look.px(5);
  for (const Rect& stroke : {Rect{{right - pixels, y}, {right, y + 2 * line}},
                             Rect{{right - pixels, y - tick}, {right - pixels + 2 * line, y}},
                             Rect{{right - 2 * line, y - tick}, {right, y}}})
    fill(stroke, look.theme.view_text);
  put_text(context.ui, look.fonts.small, look.theme.view_text,
           Rect{{right - width, y - look.px(20)}, {right, y - look.px(2)}}, length.text, Align::Centre);
}

}  // namespace limber::editor
