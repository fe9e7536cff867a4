// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/measure/ruler_overlay.h"

#include <cmath>
#include <cstdio>

#include "editor/context/context.h"
#include "editor/context/view_projection.h"
#include "editor/context/views.h"
#include "editor/ui/draw.h"

namespace limber::editor {

namespace {

constexpr float kApart = 64;  // numbers on a ruler are at least this far apart, pixels at scale 1
// Height of the horizontal ruler, width of the vertical one, pixels at scale 1.
constexpr float kHeight = 20, kWidth = 34;
constexpr float kLong = 8, kShort = 4;  // lengths of the ticks with and without a number, pixels at scale 1
constexpr int kParts = 5;               // number of tick intervals between two numbers
constexpr std::int64_t kMostTicks = 4000;

std::string number_text(double value, double step) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", step < 1 ? static_cast<int>(std::ceil(-std::log10(step))) : 0, value);
  return std::string(text) == "-0" ? "0" : text;
}

// Draws one ruler along an edge of the picture.
//   from, to   ends of the edge, pixels; the numbers are on the inner side of the edge
//   first      world coordinate at `from`, mm
//   per_pixel  change of the world coordinate along the edge, mm per pixel; may be negative
void draw_ruler(Context& context, const glm::vec2& from, const glm::vec2& to, double first, double per_pixel) {
  const Look& look = context.ui->look;
  const bool is_level = from.y == to.y;
  const float length = glm::distance(from, to);
  if (length < look.px(2 * kApart) || per_pixel == 0) return;
  const double step = ruler_step(look.px(kApart) * std::abs(per_pixel)), part = step / kParts;
  const double last = first + per_pixel * length;
  const auto begin = static_cast<std::int64_t>(std::ceil(std::min(first, last) / part)),
             end = static_cast<std::int64_t>(std::floor(std::max(first, last) / part));
  if (end - begin > kMostTicks) return;
  for (std::int64_t i = begin; i <= end; ++i) {
    const float at = std::round(static_cast<float>((double(i) * part - first) / per_pixel));
    const bool is_number = i % kParts == 0;
    const float tick = look.px(is_number ? kLong : kShort), line = look.line();
    if (is_level) fill({{from.x + at, from.y - tick}, {from.x + at + line, from.y}}, look.theme.view_text2);
    else fill({{from.x, from.y + at}, {from.x + tick, from.y + at + line}}, look.theme.view_text2);
    if (!is_number) continue;
    const std::string text = number_text(double(i) * part, step);
    const glm::vec2 size = text_size(look.fonts.small, text);
    const glm::vec2 middle = is_level ? glm::vec2(from.x + at, from.y - tick - size.y / 2)
                                      : glm::vec2(from.x + tick + look.px(3) + size.x / 2, from.y + at);
    if (at < size.x || at > length - size.x) continue;
    put_text(context.ui, look.fonts.small, look.theme.view_text2, glm::round(middle - size * 0.5f), text);
  }
}

}  // namespace

double ruler_step(double least) {
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double count : {1.0, 2.0, 5.0})
    if (count * power >= least * (1 - 1e-9)) return count * power;
  return 10 * power;
}

Rect beside_rulers(const Context& context, const Rect& slice) {
  if (!context.views->rulers) return slice;
  return {{slice.low.x + context.ui->look.px(kWidth), slice.low.y},
          {slice.high.x, slice.high.y - context.ui->look.px(kHeight)}};
}

void draw_rulers(Context& context, const ViewPlace& place) {
  if (!context.views->rulers || place.id == ViewId::Body) return;
  const ViewProjection view(context, place);
  const Rect& rect = place.rect;
  const Look& look = context.ui->look;
  const auto axis_of = [](const glm::dvec3& v) { return std::abs(v.x) > 0.5 ? 0 : std::abs(v.y) > 0.5 ? 1 : 2; };
  const int across = axis_of(view.right), upright = axis_of(view.up);
  const double scale = view.slice.millimetres_per_pixel;
  const glm::dvec3 corner = world_of(view.slice, {0, rect.height()}, rect.size()),
                   top = world_of(view.slice, {0, 0}, rect.size());
  const Colour plate = with_alpha(look.theme.view_plate, 0.5f);
  fill({{rect.low.x, rect.high.y - look.px(kHeight)}, rect.high}, plate);
  fill({rect.low, {rect.low.x + look.px(kWidth), rect.high.y - look.px(kHeight)}}, plate);
  draw_ruler(context, {rect.low.x, rect.high.y}, rect.high, corner[across], view.right[across] * scale);
  draw_ruler(context, rect.low, {rect.low.x, rect.high.y - look.px(kHeight)}, top[upright], -view.up[upright] * scale);
}

}  // namespace limber::editor
