// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/strip_panel.h"

#include <algorithm>
#include <cmath>

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/screen.h"
#include "editor/motion/timeline.h"
#include "editor/motion/timeline_ruler.h"
#include "editor/motion/timeline_tool.h"
#include "editor/ui/icons.h"
#include "editor/ui/section.h"

namespace limber::editor {

namespace {

constexpr float kList = 176, kSwitch = 20;  // widths of the list of tracks and of a track's switch, pixels at scale 1
constexpr float kRounding = 4, kLeastName = 18;
// If a repeat of a strip is narrower than this, no lines mark the repeats, pixels at scale 1.
constexpr float kLeastCycle = 6;

// ---- The list of tracks

// Draws a switch of a track and runs its operator when it is pressed. Returns whether the strips were changed.
bool draw_switch(Context& context, const StripTrack& track, const Rect& place, const char* letter, const char* id,
                 bool on) {
  const Look& look = context.ui->look;
  const Pressed pressed = press_area(context.ui, letter, place);
  fill(place, pressed.hovered ? look.theme.hover : on ? look.theme.accent_soft : look.theme.raised, look.px(3));
  if (on) outline(place, look.theme.accent, look.px(3), look.line());
  put_text(context.ui, look.fonts.small, on ? look.theme.accent_text : look.theme.text2, place, letter, Align::Centre);
  const Operator* op = find_operator(context.operators, id);
  if (pressed.hovered) operator_tooltip(context, *op, place);
  if (!pressed.clicked) return false;
  strip_view(context.timeline).track = track.name;
  run(context, *op);
  return true;
}

void draw_tracks(Context& context, const Rect& area) {
  const Look& look = context.ui->look;
  const auto active = active_track(context);
  bool renames = false;
  ImGui::PushClipRect(im(area.low), im(area.high), true);
  for (std::size_t t = shown_strips(context)->tracks.size(); t-- > 0;) {
    const StripTrack& track = shown_strips(context)->tracks[t];
    const Rect line = track_rect(context, t);
    const Rect row{{area.low.x, line.low.y}, {area.high.x, line.high.y}};
    if (intersection(row, area).empty()) continue;
    const PathScope path(context.ui, "track " + track.name);
    const bool is_active = active == t;
    fill(row, is_active ? look.theme.accent_soft : t % 2 ? look.theme.panel : look.theme.row_alt);
    const float high = row.high.y - look.px(3), low = row.low.y + look.px(3);
    const Rect solo{{row.high.x - look.px(kSwitch + 6), low}, {row.high.x - look.px(6), high}};
    const Rect mute{{solo.low.x - look.px(kSwitch + 3), low}, {solo.low.x - look.px(3), high}};
    const Rect name{{row.low.x, row.low.y}, {mute.low.x - look.px(4), row.high.y}};
    const Pressed pressed = press_area(context.ui, "name", intersection(name, area));
    if (pressed.clicked) strip_view(context.timeline).track = track.name;
    put_text(context.ui, is_active ? look.fonts.semibold : look.fonts.regular,
             plays(*shown_strips(context), t) ? look.theme.text : look.theme.text3,
             Rect{{row.low.x + look.px(12), row.low.y}, name.high}, track.name);
    renames = renames || pressed.double_clicked;
    if (draw_switch(context, track, mute, "M", "strips.mute_track", track.muted)) break;
    if (draw_switch(context, track, solo, "S", "strips.solo_track", track.solo)) break;
  }
  ImGui::PopClipRect();
  if (renames) run(context, "strips.rename_track");
}

// ---- The strips

// Darkens the corner of a strip above the line along which its influence rises or falls.
void draw_fade(const Look& look, const glm::vec2& end, const glm::vec2& full, Colour line) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const glm::vec2 corner(end.x, full.y);
  list.AddTriangleFilled(im(corner), im(full), im(end), with_alpha(look.theme.panel, 0.75f));
  list.AddLine(im(end), im(full), line, 1.2f * look.scale);
}

std::string title_of(const Strip& strip) {
  const char* sign = strip.blend == StripBlend::Replace ? "" : "+ ";
  return sign + strip.name;
}

// Draws vertical lines where one repeat of a strip ends and the next begins.
void draw_cycles(Context& context, const Strip& strip, const Rect& place, Colour colour) {
  const double steps = strip.last - strip.first, ratio = frames_per_frame(strip, strips_rate(context.document()));
  const Look& look = context.ui->look;
  const double width = steps / ratio / context.timeline->window.count * context.timeline->ruler.width();
  if (steps <= 0 || width < look.px(kLeastCycle)) return;
  for (double cycle = std::floor(strip.skip / steps) + 1; cycle < strip.repeat; ++cycle) {
    const float x = std::round(x_of(*context.timeline, strip.start + (cycle * steps - strip.skip) / ratio));
    if (x > place.high.x) return;
    if (x > place.low.x) fill({{x, place.low.y + look.px(3)}, {x + look.line(), place.high.y - look.px(3)}}, colour);
  }
}

void draw_strip(Context& context, const StripPlace& where, const StripRun& run) {
  const Look& look = context.ui->look;
  const StripView& view = strip_view(context.timeline);
  const StripTrack& track = shown_strips(context)->tracks[where.track];
  const Strip& strip = track.strips[where.index];
  const Rect place = strip_rect(context, where), seen = intersection(place, view.rows);
  if (seen.empty()) return;
  const bool sounds = plays(*shown_strips(context), where.track) && !strip.muted,
             chosen = view.chosen.contains(strip.name);
  const float alpha = sounds ? 1.0f : 0.4f, round = look.px(kRounding);
  const Colour edge = with_alpha(chosen ? look.theme.select : look.theme.accent, chosen ? 1.0f : alpha);
  fill(place, look.theme.panel, round);  // covers what was drawn below, so that it does not show through
  fill(place, with_alpha(look.theme.accent_soft, alpha), round);
  draw_cycles(context, strip, place, with_alpha(look.theme.accent_text, 0.5f * alpha));
  const auto x = [&](int frame) { return x_of(*context.timeline, frame); };
  ImGui::PushClipRect(im(seen.low), im(seen.high), true);
  if (run.fade_in > 0) draw_fade(look, {x(run.start), place.high.y}, {x(run.start + run.fade_in), place.low.y}, edge);
  if (run.fade_out > 0) draw_fade(look, {x(run.end), place.high.y}, {x(run.end - run.fade_out), place.low.y}, edge);
  ImGui::PopClipRect();
  outline(place, edge, round, chosen ? 2 * look.line() : look.line());
  const Rect words{{std::max(place.low.x, view.rows.low.x) + look.px(8), place.low.y},
                   {std::min(place.high.x, view.rows.high.x) - look.px(6), place.high.y}};
  if (words.width() > look.px(kLeastName))
    put_text(context.ui, view.active == strip.name ? look.fonts.semibold : look.fonts.regular,
             sounds ? look.theme.text : look.theme.text2, words, title_of(strip));
}

// Draws a line from the end of a strip that holds its last pose to the next strip of its track.
void draw_hold(Context& context, const StripPlace& where) {
  const Look& look = context.ui->look;
  const StripView& view = strip_view(context.timeline);
  const StripTrack& track = shown_strips(context)->tracks[where.track];
  const Strip& strip = track.strips[where.index];
  const int end = end_of(strip, strips_rate(context.document()));
  float until = view.rows.high.x;
  for (const Strip& other : track.strips) {
    if (other.muted) continue;
    if (end_of(other, strips_rate(context.document())) > end && other.start <= end) return;
    if (other.start > end) until = std::min(until, x_of(*context.timeline, other.start));
  }
  const Rect row = track_rect(context, where.track);
  const float y = std::round(row.centre().y), from = std::max(x_of(*context.timeline, end), view.rows.low.x);
  if (until > from) fill({{from, y}, {until, y + look.line()}}, look.theme.line2);
}

void draw_rows(Context& context) {
  const Look& look = context.ui->look;
  const StripView& view = strip_view(context.timeline);
  const Strips& strips = *shown_strips(context);
  for (std::size_t t = 0; t < strips.tracks.size(); ++t)
    fill(intersection(track_rect(context, t), view.rows), t % 2 ? look.theme.panel : look.theme.row_alt);
  for (std::size_t t = 0; t < strips.tracks.size(); ++t)
    for (std::size_t i = 0; i < strips.tracks[t].strips.size(); ++i)
      if (const Strip& strip = strips.tracks[t].strips[i]; strip.holds && !strip.muted) draw_hold(context, {t, i});
  for (std::size_t t = 0; t < strips.tracks.size(); ++t) {
    const std::vector<StripRun> runs = runs_of(strips.tracks[t], strips_rate(context.document()));
    for (std::size_t i = 0; i < strips.tracks[t].strips.size(); ++i) {
      const Rect place = intersection(strip_rect(context, {t, i}), view.rows);
      if (!place.empty()) register_widget(context.ui, "strip " + strips.tracks[t].strips[i].name, place);
      draw_strip(context, {t, i}, runs[i]);
    }
  }
  if (!view.box) return;
  const Rect box = intersection(*view.box, view.rows);
  fill(box, with_alpha(look.theme.select, 0.15f));
  outline(box, look.theme.select, 0, look.line());
}

void place_rows(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  Timeline& timeline = *context.timeline;
  const float left = rect.low.x + look.px(kList), right = rect.high.x - look.px(kRulerEnds);
  timeline.marks = timeline.lane = timeline.keys = {};
  timeline.ruler = {{left, rect.low.y}, {right, rect.low.y + look.px(kRulerHeight)}};
  strip_view(context.timeline).rows = {{left, timeline.ruler.high.y},
                                       {right, std::max(timeline.ruler.high.y + 1, rect.high.y)}};
  context.screen->timeline_area = timeline.area = {timeline.ruler.low, strip_view(context.timeline).rows.high};
}

}  // namespace

void draw_strips(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  Timeline& timeline = *context.timeline;
  place_rows(context, rect);
  StripView& view = strip_view(context.timeline);
  const Rect list{{rect.low.x, timeline.ruler.high.y}, {rect.low.x + look.px(kList), rect.high.y}};
  const float top = rect.low.y + look.px(1), bottom = rect.low.y + look.px(kRulerHeight - 1);
  operator_button(context, "strips.add", {{list.high.x - look.px(97), top}, {list.high.x - look.px(33), bottom}},
                  "Strip");
  operator_button(context, "strips.add_track", {{list.high.x - look.px(30), top}, {list.high.x - look.px(4), bottom}},
                  "");
  fill({{list.high.x, rect.low.y}, {list.high.x + look.line(), rect.high.y}}, look.theme.line);
  register_widget(context.ui, "ruler", timeline.ruler);
  ImGui::PushClipRect(im(timeline.area.low), im(timeline.area.high + glm::vec2(look.px(kRulerEnds), 0)), true);
  draw_ruler(context);
  ImGui::PopClipRect();
  if (!shown_strips(context) || shown_strips(context)->tracks.empty()) {
    const bool has_strips = shown_strips(context) != nullptr;
    const Rect all{{list.low.x, list.low.y}, view.rows.high};
    const Operator* op = find_operator(context.operators, has_strips ? "strips.add" : "strips.make");
    if (empty_state(context.ui, all, has_strips ? "No strips yet" : "This clip has no strips", op->label))
      run(context, *op);
    return;
  }
  scroll_tracks(context, 0);  // keeps the scroll position valid if tracks were removed
  register_widget(context.ui, "strips", view.rows);
  draw_tracks(context, list);
  if (!shown_strips(context)) return;  // a click on a track's switch may have replaced the document
  ImGui::PushClipRect(im(view.rows.low), im(view.rows.high + glm::vec2(look.px(kRulerEnds), 0)), true);
  draw_rows(context);
  ImGui::PopClipRect();
  ImGui::PushClipRect(im(timeline.area.low - glm::vec2(look.px(26), 0)),
                      im(timeline.area.high + glm::vec2(look.px(kRulerEnds), 0)), true);
  draw_play_head(context, {});
  ImGui::PopClipRect();
}

}  // namespace limber::editor
