// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/strip_view.h"

#include <algorithm>
#include <cmath>

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/screen.h"
#include "editor/motion/graph.h"
#include "editor/motion/timeline_tool.h"
#include "editor/shown/shown_pose.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

constexpr float kGap = 1;  // distance of a strip from the upper and lower edge of its track, pixels at scale 1

// Applies an edit of the clip's strips. If the clip had no strips, or its playing range was the range of frames that
// the strips filled, the playing range becomes the range that the changed strips fill.
void change_clip(Clip& clip, const std::function<void(Strips&)>& edit) {
  Strips strips = clip.strips ? *clip.strips : Strips{};
  const auto before = span_of(strips, clip.rate);
  edit(strips);
  require_within_limits(strips);
  const auto after = span_of(strips, clip.rate);
  const bool is_whole = !before || (clip.range_start == before->first && clip.range_end == before->last);
  if (is_whole && after) clip.range_start = after->first, clip.range_end = after->last;
  if (!clip.strips || strips != *clip.strips) clip.strips = std::make_shared<const Strips>(std::move(strips));
}

Strip* find_active(Strips& strips, const std::string& name) {
  const auto place = find_strip(strips, name);
  return place ? &strips.tracks[place->track].strips[place->index] : nullptr;
}

// Applies the edit to the strip with this name, and sorts the strips of its track by their starts again.
void change_one(Strips& strips, const std::string& name, const std::function<void(Strip&)>& edit) {
  Strip* strip = find_active(strips, name);
  if (!strip) return;
  edit(*strip);
  strip->skip = std::min(strip->skip, frames_of_cycles(*strip));
  for (StripTrack& track : strips.tracks) sort_strips(track);
}

}  // namespace

StripView& strip_view(Timeline& timeline) {
  auto& view = timeline.strips;
  if (!view) view = std::make_shared<StripView>();
  return *view;
}

bool strips_are_shown(const Context& context) {
  return context.timeline->shows_strips && context.timeline->strips && context.screen->arrangement().timeline &&
         !context.screen->arrangement().console;
}

void show_strips(Context& context, bool on) {
  if (on) {
    if (context.timeline->shows_graph) show_graph(context, false);
    strip_view(context.timeline);
    Arrangement& arrangement = context.screen->arrangement();
    arrangement.timeline = true;
    arrangement.console = false;
    // Deselects the keys in the timeline's rows: these rows are now hidden, and hidden keys must not be changed.
    context.timeline->chosen.clear();
  }
  context.timeline->shows_strips = on;
  context.ui->touch();
}

const Strips* shown_strips(const Context& context) {
  const Clip* clip = shown_clip(context.document());
  if (!clip || !clip->strips) return nullptr;
  const auto& view = context.timeline->strips;
  return view && view->preview && view->previewed.get() == clip ? &*view->preview : clip->strips.get();
}

double strips_rate(const Document& document) { return frame_rate(document); }

std::set<std::string> chosen_strips(const Context& context) {
  std::set<std::string> found;
  const Strips* strips = shown_strips(context);
  if (!strips || !strips_are_shown(context)) return found;
  for (const std::string& name : context.timeline->strips->chosen)
    if (find_strip(*strips, name)) found.insert(name);
  return found;
}

const Strip* active_strip(const Context& context) {
  const Strips* strips = shown_strips(context);
  if (!strips || !strips_are_shown(context)) return nullptr;
  const auto place = find_strip(*strips, context.timeline->strips->active);
  return place ? &strips->tracks[place->track].strips[place->index] : nullptr;
}

std::optional<std::size_t> active_track(const Context& context) {
  const Strips* strips = shown_strips(context);
  if (!strips || !strips_are_shown(context)) return std::nullopt;
  const StripView& view = *context.timeline->strips;
  for (std::size_t t = 0; t < strips->tracks.size(); ++t)
    if (strips->tracks[t].name == view.track) return t;
  if (const auto place = find_strip(*strips, view.active)) return place->track;
  return strips->tracks.empty() ? std::nullopt : std::optional<std::size_t>(0);
}

void choose_strip(Context& context, const std::string& name) {
  StripView& view = strip_view(context.timeline);
  view.chosen = {name};
  view.active = name;
  if (const Strips* strips = shown_strips(context))
    if (const auto place = find_strip(*strips, name)) view.track = strips->tracks[place->track].name;
}

void change_strips(Context& context, const std::string& label, const std::function<void(Strips&)>& edit) {
  stop_playing(context);
  settle_frame(context);
  drop_strip_preview(context);
  attempt(context, label,
          [&](Context& c) { edit_clip(c, label, PoseThen::FromClip, [&](Clip& clip) { change_clip(clip, edit); }); });
}

void preview_strips(Context& context, Strips strips) {
  StripView& view = strip_view(context.timeline);
  const Clip* shown = shown_clip(context.document());
  const ClipOnRig* on_rig = clip_on_rig(context);
  if (on_rig) {
    Clip clip = *shown;
    clip.strips = std::make_shared<const Strips>(strips);
    show_pose(
        context,
        ClipOnRig(std::make_shared<const Clip>(std::move(clip)), on_rig->armature(), on_rig).at(shown_frame(context)));
  }
  view.preview = std::move(strips);
  view.previewed = graph_clip(context.document());
  context.ui->touch();
}

void drop_strip_preview(Context& context) {
  StripView& view = strip_view(context.timeline);
  if (!view.preview) return;
  view.preview.reset();
  view.previewed.reset();
  view.snapped.reset();
  drop_shown_pose(context);
  context.ui->touch();
}

void change_active_strip(Context& context, const std::string& label, const std::function<void(Strip&)>& edit) {
  const std::string name = strip_view(context.timeline).active;
  change_strips(context, label, [&](Strips& strips) { change_one(strips, name, edit); });
}

void preview_active_strip(Context& context, const std::function<void(Strip&)>& edit) {
  if (!shown_clip(context.document()) || !shown_clip(context.document())->strips) return;
  Strips strips = *shown_clip(context.document())->strips;
  change_one(strips, strip_view(context.timeline).active, edit);
  preview_strips(context, std::move(strips));
}

Rect track_rect(const Context& context, std::size_t track) {
  const StripView& view = *context.timeline->strips;
  const Look& look = context.ui->look;
  const float height = look.px(kTrackHeight);
  const auto below = static_cast<float>(shown_strips(context)->tracks.size() - 1 - track);
  const float y = view.rows.low.y - look.px(view.scroll) + below * height;
  return {{view.rows.low.x, y}, {view.rows.high.x, y + height}};
}

Rect strip_rect(const Context& context, const StripPlace& place) {
  const Strip& strip = shown_strips(context)->tracks[place.track].strips[place.index];
  const Timeline& timeline = *context.timeline;
  const Rect row = track_rect(context, place.track);
  const float gap = context.ui->look.px(kGap), left = std::round(x_of(timeline, strip.start)),
              right = std::round(x_of(timeline, end_of(strip, strips_rate(context.document()))));
  return {{left, row.low.y + gap}, {std::max(right, left + context.ui->look.px(3)), row.high.y - gap}};
}

int track_at(const Context& context, float y) {
  const StripView& view = *context.timeline->strips;
  const float from_top = y - view.rows.low.y + context.ui->look.px(view.scroll);
  return static_cast<int>(shown_strips(context)->tracks.size()) - 1 -
         static_cast<int>(std::floor(from_top / context.ui->look.px(kTrackHeight)));
}

void scroll_tracks(Context& context, float by) {
  StripView& view = strip_view(context.timeline);
  const Strips* strips = shown_strips(context);
  const float all = strips ? static_cast<float>(strips->tracks.size()) * kTrackHeight : 0;
  view.scroll = std::clamp(view.scroll + by, 0.0f, std::max(0.0f, all - view.rows.height() / context.ui->look.scale));
}

}  // namespace limber::editor
