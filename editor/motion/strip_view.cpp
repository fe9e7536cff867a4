// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/strip_view.h"

#include <algorithm>
#include <cmath>

#include "editor/context/operator.h"
#include "editor/motion/graph.h"
#include "editor/motion/timeline_tool.h"
#include "editor/shown/shown_pose.h"

namespace limber::editor {

namespace {

constexpr float kGap = 1;  // free height above and below a strip in its track, pixels at scale 1

// Applies an edit of the strips. If the playing range was the range of the strips before, it is so afterwards.
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

// Applies the edit to one strip, and sorts its track again.
void change_one(Strips& strips, const std::string& name, const std::function<void(Strip&)>& edit) {
  Strip* strip = find_active(strips, name);
  if (!strip) return;
  edit(*strip);
  strip->skip = std::min(strip->skip, frames_of_cycles(*strip));
  for (StripTrack& track : strips.tracks) sort_strips(track);
}

}  // namespace

StripView& strip_view(Editor& editor) {
  auto& view = editor.timeline->strips;
  if (!view) view = std::make_shared<StripView>();
  return *view;
}

bool strips_are_shown(const Editor& editor) {
  return editor.timeline->shows_strips && editor.timeline->strips && editor.arrangement().timeline &&
         !editor.arrangement().console;
}

void show_strips(Editor& editor, bool on) {
  if (on) {
    if (editor.timeline->shows_graph) show_graph(editor, false);
    strip_view(editor);
    Arrangement& arrangement = editor.arrangement();
    arrangement.timeline = true;
    arrangement.console = false;
    editor.timeline->chosen.clear();  // the rows of keys are hidden, and hidden keys must not be changed
  }
  editor.timeline->shows_strips = on;
  editor.touch();
}

const Strips* shown_strips(const Editor& editor) {
  const Clip* clip = shown_clip(editor);
  if (!clip || !clip->strips) return nullptr;
  const auto& view = editor.timeline->strips;
  return view && view->preview && view->previewed.get() == clip ? &*view->preview : clip->strips.get();
}

double strips_rate(const Editor& editor) { return frame_rate(editor); }

std::set<std::string> chosen_strips(const Editor& editor) {
  std::set<std::string> found;
  const Strips* strips = shown_strips(editor);
  if (!strips || !strips_are_shown(editor)) return found;
  for (const std::string& name : editor.timeline->strips->chosen)
    if (find_strip(*strips, name)) found.insert(name);
  return found;
}

const Strip* active_strip(const Editor& editor) {
  const Strips* strips = shown_strips(editor);
  if (!strips || !strips_are_shown(editor)) return nullptr;
  const auto place = find_strip(*strips, editor.timeline->strips->active);
  return place ? &strips->tracks[place->track].strips[place->index] : nullptr;
}

std::optional<std::size_t> active_track(const Editor& editor) {
  const Strips* strips = shown_strips(editor);
  if (!strips || !strips_are_shown(editor)) return std::nullopt;
  const StripView& view = *editor.timeline->strips;
  for (std::size_t t = 0; t < strips->tracks.size(); ++t)
    if (strips->tracks[t].name == view.track) return t;
  if (const auto place = find_strip(*strips, view.active)) return place->track;
  return strips->tracks.empty() ? std::nullopt : std::optional<std::size_t>(0);
}

void choose_strip(Editor& editor, const std::string& name) {
  StripView& view = strip_view(editor);
  view.chosen = {name};
  view.active = name;
  if (const Strips* strips = shown_strips(editor))
    if (const auto place = find_strip(*strips, name)) view.track = strips->tracks[place->track].name;
}

void change_strips(Editor& editor, const std::string& label, const std::function<void(Strips&)>& edit) {
  stop_playing(editor);
  settle_frame(editor);
  drop_strip_preview(editor);
  attempt(editor, label,
          [&](Editor& e) { edit_clip(e, label, PoseThen::FromClip, [&](Clip& clip) { change_clip(clip, edit); }); });
}

void preview_strips(Editor& editor, Strips strips) {
  StripView& view = strip_view(editor);
  const Clip* shown = shown_clip(editor);
  const ClipOnRig* on_rig = clip_on_rig(editor);
  if (on_rig) {
    Clip clip = *shown;
    clip.strips = std::make_shared<const Strips>(strips);
    show_pose(
        editor,
        ClipOnRig(std::make_shared<const Clip>(std::move(clip)), on_rig->armature(), on_rig).at(shown_frame(editor)));
  }
  view.preview = std::move(strips);
  view.previewed = graph_clip(editor);
  editor.touch();
}

void drop_strip_preview(Editor& editor) {
  StripView& view = strip_view(editor);
  if (!view.preview) return;
  view.preview.reset();
  view.previewed.reset();
  view.snapped.reset();
  drop_shown_pose(editor);
  editor.touch();
}

void change_active_strip(Editor& editor, const std::string& label, const std::function<void(Strip&)>& edit) {
  const std::string name = strip_view(editor).active;
  change_strips(editor, label, [&](Strips& strips) { change_one(strips, name, edit); });
}

void preview_active_strip(Editor& editor, const std::function<void(Strip&)>& edit) {
  if (!shown_clip(editor) || !shown_clip(editor)->strips) return;
  Strips strips = *shown_clip(editor)->strips;
  change_one(strips, strip_view(editor).active, edit);
  preview_strips(editor, std::move(strips));
}

Rect track_rect(const Editor& editor, std::size_t track) {
  const StripView& view = *editor.timeline->strips;
  const Look& look = editor.look;
  const float height = look.px(kTrackHeight);
  const auto below = static_cast<float>(shown_strips(editor)->tracks.size() - 1 - track);
  const float y = view.rows.low.y - look.px(view.scroll) + below * height;
  return {{view.rows.low.x, y}, {view.rows.high.x, y + height}};
}

Rect strip_rect(const Editor& editor, const StripPlace& place) {
  const Strip& strip = shown_strips(editor)->tracks[place.track].strips[place.index];
  const Timeline& timeline = *editor.timeline;
  const Rect row = track_rect(editor, place.track);
  const float gap = editor.look.px(kGap), left = std::round(x_of(timeline, strip.start)),
              right = std::round(x_of(timeline, end_of(strip, strips_rate(editor))));
  return {{left, row.low.y + gap}, {std::max(right, left + editor.look.px(3)), row.high.y - gap}};
}

int track_at(const Editor& editor, float y) {
  const StripView& view = *editor.timeline->strips;
  const float from_top = y - view.rows.low.y + editor.look.px(view.scroll);
  return static_cast<int>(shown_strips(editor)->tracks.size()) - 1 -
         static_cast<int>(std::floor(from_top / editor.look.px(kTrackHeight)));
}

void scroll_tracks(Editor& editor, float by) {
  StripView& view = strip_view(editor);
  const Strips* strips = shown_strips(editor);
  const float all = strips ? static_cast<float>(strips->tracks.size()) * kTrackHeight : 0;
  view.scroll = std::clamp(view.scroll + by, 0.0f, std::max(0.0f, all - view.rows.height() / editor.look.scale));
}

}  // namespace limber::editor
