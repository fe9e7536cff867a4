// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/graph_panel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "editor/context/context.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/motion/graph_tool.h"
#include "editor/motion/timeline_ruler.h"
#include "editor/motion/timeline_tool.h"
#include "editor/ui/section.h"

namespace limber::editor {

namespace {

// Widths, pixels at scale 1: the list of tracks, the numbers beside the plot, a channel's button.
constexpr float kList = 176, kValues = 62, kButton = 20;
constexpr float kLeastValues = 26;  // the numbers beside the plot are at least this far apart, pixels at scale 1
constexpr int kMostTicks = 1000;
// If neighbouring frames are farther apart than this, curves are also sampled between frames; pixels at scale 1.
constexpr float kFine = 5;
constexpr float kKeyRadius = 4, kHandleRadius = 3.5f;
constexpr const char* kAxes[] = {"X", "Y", "Z"};

// ---- The list of tracks

std::string name_of(const GraphTrack& track) { return track.is_shift ? track.bone + " shift" : track.bone; }

void draw_channel_button(Context& context, const GraphChannel& channel, const Rect& place) {
  const Look& look = context.ui->look;
  Graph& graph = graph_of(context);
  const bool shown = !graph.hidden.contains(channel);
  const Pressed pressed = press_area(context.ui, kAxes[channel.axis], place);
  fill(place, pressed.hovered ? look.theme.hover : shown ? look.theme.raised : look.theme.panel, look.px(3));
  const Rect edge{{place.low.x + look.px(2), place.high.y - look.px(4)},
                  {place.high.x - look.px(2), place.high.y - look.px(2)}};
  fill(edge, with_alpha(look.theme.axis[channel.axis], shown ? 1.0f : 0.25f));
  put_text(context.ui, look.fonts.small, shown ? look.theme.text : look.theme.text3, place, kAxes[channel.axis],
           Align::Centre);
  if (pressed.hovered)
    tooltip(context.ui, place, name_of(channel.track) + " " + kAxes[channel.axis],
            "Click to show or hide this curve. Ctrl+click to show only this curve.");
  if (!pressed.clicked) return;
  if (context.ui->input.modifiers().ctrl) {
    graph.hidden.clear();
    for (const auto& [track, curve] : graph.curves.tracks)
      for (int axis = 0; axis < 3; ++axis) graph.hidden.insert({track, axis});
    graph.hidden.erase(channel);
  } else if (shown) {
    graph.hidden.insert(channel);
  } else {
    graph.hidden.erase(channel);
  }
}

void draw_list(Context& context, const Rect& area, const GraphTracks& found) {
  const Look& look = context.ui->look;
  Column column(context.ui, "channels", area);
  const auto words = [&](const std::string& text) {
    const Rect row = column.row(22);
    put_text(context.ui, look.fonts.small, look.theme.text3, Rect{{row.low.x + look.px(12), row.low.y}, row.high},
             text);
  };
  if (found.tracks.empty()) words("Select a bone");
  int index = 0;
  for (const GraphTrack& track : found.tracks) {
    Rect row;
    if (!column.list_row(row, index++, false)) continue;
    const PathScope path(context.ui, name_of(track));
    float right = row.high.x - look.px(6);
    for (int axis = 2; axis >= 0; --axis) {
      const Rect place{{right - look.px(kButton), row.low.y + look.px(2)}, {right, row.high.y - look.px(2)}};
      draw_channel_button(context, {track, axis}, place);
      right = place.low.x - look.px(3);
    }
    put_text(context.ui, look.fonts.regular, look.theme.text2,
             Rect{{row.low.x + look.px(12), row.low.y}, {right - look.px(2), row.high.y}}, name_of(track));
  }
  if (found.left_out > 0) words("and " + std::to_string(found.left_out) + " more: select fewer bones");
}

// ---- The plot

// Returns the unit of the shown values: "" when both angles and translations are shown.
const char* unit_of(const Graph& graph) {
  bool angles = false, shifts = false;
  for (const auto& [track, curve] : graph.curves.tracks)
    for (int axis = 0; axis < 3; ++axis)
      if (is_shown(graph, {track, axis})) (track.is_shift ? shifts : angles) = true;
  return angles && shifts ? "" : shifts ? " mm" : "\u00b0";
}

void draw_values(Context& context) {
  const Look& look = context.ui->look;
  const Graph& graph = graph_of(context);
  const double per_pixel = (graph.high - graph.low) / std::max(1.0f, graph.plot.height());
  const double step = round_step(look.px(kLeastValues) * per_pixel);
  const char* unit = unit_of(graph);
  // The tick numbers are doubles, because an integer could overflow. The number of ticks is limited, because at very
  // large values adding a step may not change a double.
  const double first = std::ceil(graph.low / step);
  for (int i = 0; i < kMostTicks && (first + i) * step <= graph.high; ++i) {
    const double value = (first + i) * step;
    const float y = std::round(graph_y(graph, value));
    fill({{graph.plot.low.x, y}, {graph.plot.high.x, y + look.line()}},
         value == 0 ? look.theme.line2 : with_alpha(look.theme.line, 0.6f));
    char text[32];
    std::snprintf(text, sizeof text, step >= 1 ? "%.0f%s" : "%.3g%s", value, unit);
    const float half = look.px(8);
    if (y - half < graph.plot.low.y || y + half > graph.plot.high.y) continue;
    put_text(context.ui, look.fonts.small_mono, look.theme.text3,
             Rect{{graph.plot.low.x - look.px(kValues), y - half}, {graph.plot.low.x - look.px(6), y + half}}, text,
             Align::Right);
  }
}

// Draws a line through the values at whole frames. If frames are far apart, the line also passes through the values
// that `fine` returns between frames; `fine` may be empty.
void draw_line(Context& context, const std::vector<glm::dvec3>& values, int axis, Colour colour, float width,
               const std::function<glm::dvec3(double)>& fine) {
  const Timeline& timeline = *context.timeline;
  const Graph& graph = graph_of(context);
  const int first = graph.curves.range.low, last = first + static_cast<int>(values.size()) - 1;
  const double per_frame = timeline.ruler.width() / timeline.window.count;
  const int low = static_cast<int>(std::clamp(std::floor(timeline.window.low), double(first), double(last)));
  const int high =
      static_cast<int>(std::clamp(std::ceil(timeline.window.low + timeline.window.count), double(first), double(last)));
  const int parts = fine ? std::clamp(static_cast<int>(per_frame / context.ui->look.px(kFine)), 1, 16) : 1;
  // If several frames fall into half a pixel, only some of them are drawn.
  const int stride = std::max(1, static_cast<int>(std::floor(0.5 / std::max(per_frame, 1e-9))));
  ImDrawList& list = *ImGui::GetWindowDrawList();
  for (int frame = low; frame <= high; frame += stride) {
    list.PathLineTo({x_of(timeline, frame), graph_y(graph, values[frame - first][axis])});
    if (frame < high)
      for (int part = 1; part < parts; ++part) {
        const double at = frame + static_cast<double>(part) / parts;
        list.PathLineTo({x_of(timeline, at), graph_y(graph, fine(at)[axis])});
      }
  }
  list.PathStroke(colour, 0, width);
}

void draw_curves(Context& context) {
  const Look& look = context.ui->look;
  const Graph& graph = graph_of(context);
  const std::string active = context.selection->bone && context.document().armature &&
                                     *context.selection->bone < std::ssize(context.document().armature->bones)
                                 ? context.document().armature->bones[*context.selection->bone].name
                                 : "";
  for (const bool keyed : {false, true})
    for (const auto& [track, curve] : graph.curves.tracks) {
      const bool has_keys = !curve.turns.empty() || !curve.shifts.empty();
      const bool faint = keyed && !active.empty() && track.bone != active;
      for (int axis = 0; axis < 3; ++axis) {
        if (!is_shown(graph, {track, axis})) continue;
        if (!keyed && has_keys && !curve.motion.empty())
          draw_line(context, curve.motion, axis, with_alpha(look.theme.text3, 0.55f), look.scale, {});
        if (keyed && !curve.values.empty())
          draw_line(context, curve.values, axis, with_alpha(look.theme.axis[axis], faint ? 0.45f : 1.0f),
                    (faint ? 1.0f : 1.6f) * look.scale,
                    [&, t = &track](double frame) { return graph_values(graph.curves, *t, frame); });
      }
    }
}

// Draws the keys of one track. If several keys lie at the same point, only the first of these and the selected keys are
// drawn.
void draw_keys_of(Context& context, const GraphTrack& track) {
  const Look& look = context.ui->look;
  const Graph& graph = graph_of(context);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const std::set<int> frames = key_frames_of(graph_keys(context), track);
  for (int axis = 0; axis < 3; ++axis) {
    if (!is_shown(graph, {track, axis})) continue;
    std::optional<glm::vec2> before;
    bool before_chosen = false;
    for (const int frame : frames) {
      const float x = x_of(*context.timeline, frame);
      if (x < graph.plot.low.x - look.px(8) || x > graph.plot.high.x + look.px(8)) continue;
      const GraphKey key{{track, axis}, frame};
      const glm::vec2 point = graph_point(context.timeline, key);
      const bool chosen = graph.chosen.contains(key);
      if (before && glm::distance(*before, point) < look.px(kKeyRadius) && (before_chosen || !chosen)) continue;
      list.AddCircleFilled(im(point), look.px(kKeyRadius + 1), look.theme.field);
      list.AddCircleFilled(im(point), look.px(kKeyRadius), chosen ? look.theme.select : look.theme.axis[axis]);
      before = point;
      before_chosen = chosen;
    }
  }
}

void draw_keys_and_handles(Context& context) {
  const Look& look = context.ui->look;
  const Graph& graph = graph_of(context);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  for (const GraphHandle& handle : graph_handles(context)) {
    list.AddLine(im(handle.key_point), im(handle.point), look.theme.select, look.scale);
    list.AddCircleFilled(im(handle.point), look.px(kHandleRadius), look.theme.field);
    list.AddCircle(im(handle.point), look.px(kHandleRadius), look.theme.select, 0, 1.5f * look.scale);
  }
  for (const auto& [track, curve] : graph.curves.tracks) draw_keys_of(context, track);
  if (!graph.box) return;
  const Rect box = intersection(*graph.box, graph.plot);
  fill(box, with_alpha(look.theme.select, 0.15f));
  outline(box, look.theme.select, 0, look.line());
}

// Returns a text that identifies the shown clip and tracks. When this text changes, the value axis is fitted again.
std::string shown_name(const Context& context, const GraphTracks& found) {
  std::string name = shown_clip(context.document())->name;
  for (const GraphTrack& track : found.tracks) name += "/" + name_of(track);
  return name;
}

}  // namespace

void draw_graph(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  Timeline& timeline = *context.timeline;
  Graph& graph = graph_of(context);
  const float left = rect.low.x + look.px(kList + kValues), right = rect.high.x - look.px(kRulerEnds);
  timeline.marks = timeline.lane = timeline.keys = {};
  timeline.ruler = {{left, rect.low.y}, {right, rect.low.y + look.px(kRulerHeight)}};
  graph.plot = {{left, timeline.ruler.high.y}, {right, std::max(timeline.ruler.high.y + 1, rect.high.y)}};
  context.screen->timeline_area = timeline.area = {timeline.ruler.low, graph.plot.high};
  context.screen->graph_area = graph.plot;

  const GraphTracks found = graph_tracks(context);
  if (context.document().armature) update_curves(context);
  else graph.curves = {};
  if (const std::string name = shown_name(context, found); graph.fitted != name && graph.curves.complete()) {
    fit_graph_values(context);
    graph.fitted = name;
  }
  draw_list(context, {{rect.low.x, timeline.ruler.high.y}, {rect.low.x + look.px(kList), rect.high.y}}, found);
  fill({{rect.low.x + look.px(kList), rect.low.y}, {rect.low.x + look.px(kList) + look.line(), rect.high.y}},
       look.theme.line);
  register_widget(context.ui, "ruler", timeline.ruler);
  register_widget(context.ui, "graph", graph.plot);
  fill(graph.plot, look.theme.field);
  ImGui::PushClipRect(im(timeline.area.low - glm::vec2(look.px(kValues), 0)),
                      im(timeline.area.high + glm::vec2(look.px(kRulerEnds), 0)), true);
  draw_ruler(context);
  draw_values(context);
  ImGui::PushClipRect(im(graph.plot.low), im(graph.plot.high), true);
  if (!graph.curves.tracks.empty()) {
    draw_curves(context);
    draw_keys_and_handles(context);
  } else {
    put_text(context.ui, look.fonts.regular, look.theme.text2, graph.plot, "Select bones to see their curves",
             Align::Centre);
  }
  ImGui::PopClipRect();
  draw_play_head(context, {});
  ImGui::PopClipRect();
}

}  // namespace limber::editor
