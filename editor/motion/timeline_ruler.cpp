// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/timeline_ruler.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/motion/timeline.h"
#include "editor/motion/timeline_tool.h"
#include "editor/ui/draw.h"

namespace limber::editor {

namespace {

constexpr float kLeastTicks = 60;  // the numbers of the ruler are at least this far apart, pixels at scale 1

std::string seconds_text(double frames, double rate) {
  char text[24];
  std::snprintf(text, sizeof text, "%.2f s", frames / rate);
  return text;
}

std::string frame_text(int frame) { return "frame " + std::to_string(frame); }

// The drawn play head: a vertical line with a tab in the ruler. The tab shows the frame or the time in seconds,
// as the ruler does. While the line is left or right of the shown frames, the tab stays at that end of the ruler.
struct Head {
  float x;
  int beyond;  // where the play head is: -1 left of the shown frames, 1 right of them, 0 within them
  std::string text, other;
  Rect tab;
};

Head head_of(const Context& context) {
  const Look& look = context.ui->look;
  const Timeline& timeline = *context.timeline;
  const int frame = shown_frame(context);
  const std::string seconds = seconds_text(frame, frame_rate(context.document()));
  Head head{std::round(x_of(timeline, frame)),
            0,
            timeline.seconds ? seconds : std::to_string(frame),
            timeline.seconds ? frame_text(frame) : seconds,
            {}};
  head.beyond = head.x < timeline.ruler.low.x - 1 ? -1 : head.x > timeline.ruler.high.x + 1 ? 1 : 0;
  const float half = std::round(
      std::max(look.px(48), text_size(look.fonts.small_mono, head.text).x + look.px(head.beyond ? 28 : 12)) / 2);
  const float x = head.beyond ? std::clamp(head.x, timeline.ruler.low.x + half, timeline.ruler.high.x - half) : head.x;
  head.tab = {{x - half, timeline.ruler.low.y + look.px(2)}, {x + half, timeline.ruler.low.y + look.px(20)}};
  return head;
}

}  // namespace

double round_step(double least) {
  const double power = std::pow(10, std::floor(std::log10(std::max(least, 1e-6))));
  for (double step : {1.0, 2.0, 5.0})
    if (step * power >= least * (1 - 1e-9)) return step * power;
  return 10 * power;
}

void draw_ruler(Context& context) {
  const Look& look = context.ui->look;
  const Timeline& timeline = *context.timeline;
  const Rect& ruler = timeline.ruler;
  const FrameRange range = playing_range(context.document());
  fill(ruler, look.theme.field);
  const Rect inside =
      intersection(ruler, {{x_of(timeline, range.low), ruler.low.y}, {x_of(timeline, range.high), ruler.high.y}});
  if (!inside.empty()) fill(inside, look.theme.accent_soft);
  for (int end : {range.low, range.high}) {
    const float x = std::round(x_of(timeline, end));
    if (x >= ruler.low.x && x < ruler.high.x)
      fill({{x, ruler.low.y}, {x + look.line(), timeline.area.high.y}}, look.theme.line2);
  }
  const double unit = timeline.seconds ? frame_rate(context.document()) : 1,
               per_pixel = timeline.window.count / std::max(1.0f, ruler.width());
  double step = round_step(look.px(kLeastTicks) * per_pixel / unit);
  if (!timeline.seconds) step = std::max(1.0, step);
  const double minor = step / 5, end = (timeline.window.low + timeline.window.count) / unit;
  const Rect tab = head_of(context).tab;
  for (auto i = static_cast<std::int64_t>(std::ceil(timeline.window.low / unit / minor));
       static_cast<double>(i) * minor <= end; ++i) {
    const double at = static_cast<double>(i) * minor;
    const bool major = i % 5 == 0;
    const float x = std::round(x_of(timeline, at * unit));
    fill({{x, ruler.high.y - look.px(major ? 14 : 5)}, {x + look.line(), ruler.high.y}}, look.theme.line2);
    if (!major) continue;
    char text[24];
    std::snprintf(text, sizeof text, timeline.seconds && step < 1 ? "%.2f" : "%.0f", at);
    const glm::vec2 corner(x + look.px(4), ruler.low.y + look.px(2));
    const Rect place{corner - look.px(3), corner + text_size(look.fonts.small_mono, text) + look.px(3)};
    // A number is not drawn if the play head's tab would cover it or the ruler's end would cut it off.
    if (intersection(place, tab).empty() && place.high.x <= ruler.high.x + look.px(kRulerEnds))
      put_text(context.ui, look.fonts.small_mono, look.theme.text2, corner, text);
  }
}

void draw_play_head(Context& context, const std::vector<Rect>& covered) {
  const Look& look = context.ui->look;
  const Timeline& timeline = *context.timeline;
  const Head head = head_of(context);
  fill(head.tab, look.theme.select, look.px(4));
  if (head.beyond) {
    const float side = static_cast<float>(head.beyond),
                tip = (side > 0 ? head.tab.high.x : head.tab.low.x) - side * look.px(5), y = head.tab.centre().y;
    ImGui::GetWindowDrawList()->AddTriangleFilled({tip, y}, {tip - side * look.px(6), y - look.px(5)},
                                                  {tip - side * look.px(6), y + look.px(5)}, look.theme.on_select);
    const Rect rest = side > 0 ? Rect{head.tab.low, {tip - look.px(6), head.tab.high.y}}
                               : Rect{{tip + look.px(6), head.tab.low.y}, head.tab.high};
    return put_text(context.ui, look.fonts.small_mono, look.theme.on_select, rest, head.text, Align::Centre);
  }
  const float half = std::max(1.0f, std::round(look.scale));
  fill({{head.x - half, timeline.ruler.low.y}, {head.x + half, timeline.area.high.y}}, look.theme.select);
  put_text(context.ui, look.fonts.small_mono, look.theme.on_select, head.tab, head.text, Align::Centre);
  if (timeline.marks.empty()) return;
  const Rect& row = timeline.marks;
  const float width = text_size(look.fonts.small_mono, head.other).x + 1;
  for (const float left : {head.x + look.px(8), head.x - look.px(8) - width}) {
    const Rect place{{left, row.low.y}, {left + width, row.high.y}};
    const bool free = std::none_of(covered.begin(), covered.end(),
                                   [&](const Rect& other) { return !intersection(place, other).empty(); });
    if (free && place.low.x >= row.low.x && place.high.x <= row.high.x + look.px(kRulerEnds))
      return put_text(context.ui, look.fonts.small_mono, look.theme.select, place, head.other);
  }
}

void follow_head(Context& context) {
  auto& window = context.timeline->window;
  const int frame = shown_frame(context);
  if (window.followed == frame || context.interaction->drag) return;
  const bool first = !window.followed;
  window.followed = frame;
  if (first) return;
  if (frame < window.low) window.low = frame - 0.9 * window.count;
  else if (frame > window.low + window.count) window.low = frame - 0.1 * window.count;
}

}  // namespace limber::editor
