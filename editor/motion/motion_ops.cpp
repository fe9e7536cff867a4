// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of the timeline: playing, stepping, scrubbing, the playing range, keys, markers and the onion skin.
#include <algorithm>
#include <cmath>

#include "core/motion/clip_keys.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/motion/constrained_pose.h"
#include "editor/motion/timeline.h"
#include "editor/motion/timeline_tool.h"
#include "editor/shown/shown_pose.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

constexpr char kPingPongIcon[] = "\uf07e";
constexpr double kSpeeds[] = {0.1, 0.25, 0.5, 1, 2, 4};
// Zoom factor per wheel step, and the most frames that the timeline shows.
constexpr double kZoomStep = 1.25, kMostFrames = 1e7;

std::string needs_clip(const Context& context) {
  return shown_clip(context.document()) ? "" : "Import a motion first, or insert a key";
}
std::string needs_rig(const Context& context) { return context.document().armature ? "" : "Import a rig first"; }
std::string needs_keys(const Context& context) {
  const Clip* clip = shown_clip(context.document());
  return clip && !clip->keys.empty() ? "" : "There are no keys yet: insert a key first";
}

void toggle_play(Context& context, int direction) {
  const auto& playing = context.timeline->play;
  if (playing.on && playing.direction == direction) return stop_playing(context);
  play(context, direction);
}

void step(Context& context, int frames) {
  const bool was_playing = context.timeline->play.on;
  stop_playing(context);
  if (!was_playing || std::abs(frames) > 1) go_to_frame(context, shown_frame(context) + frames);
}

void go(Context& context, int frame) {
  stop_playing(context);
  go_to_frame(context, frame);
}

void go_to_key(Context& context, int direction) {
  const std::set<int> frames = frames_of(shown_clip(context.document())->keys);
  const int now = shown_frame(context);
  if (direction > 0) {
    const auto next = frames.upper_bound(now);
    if (next != frames.end()) go(context, *next);
  } else if (const auto next = frames.lower_bound(now); next != frames.begin()) {
    go(context, *std::prev(next));
  }
}

void set_range(Context& context, bool start) {
  const int frame = shown_frame(context);
  edit_clip(context, start ? "Set start of range" : "Set end of range", PoseThen::Stays, [&](Clip& clip) {
    (start ? clip.range_start : clip.range_end) = frame;
    if (clip.range_start > clip.range_end) (start ? clip.range_end : clip.range_start) = frame;
  });
}

void change_speed(Context& context, int by) {
  auto& playing = context.timeline->play;
  const int count = static_cast<int>(std::size(kSpeeds));
  int place = 0;
  while (place + 1 < count && kSpeeds[place] < playing.speed) ++place;
  const double speed = by == 0 ? 1 : kSpeeds[std::clamp(place + by, 0, count - 1)];
  playing.from = shown_frame(context);
  playing.since = context.ui->now;
  playing.speed = speed;
  playing.pictures_per_second = 0;
}

void insert_key_here(Context& context) {
  settle_frame(context);
  const std::vector<int> bones = chosen_bones(context);
  const Pose pose = unconstrained_pose(context);
  const int frame = context.document().frame;
  const std::shared_ptr<const Armature> armature = context.document().armature;
  const auto insert = [&](Clip& clip) { insert_key(clip.keys, *armature, pose, bones, frame); };
  if (is_constrained(context.document())) change_free_clip(context, "Insert key", insert);
  else edit_clip(context, "Insert key", PoseThen::Stays, insert);
}

void delete_key_here(Context& context) {
  settle_frame(context);
  const std::shared_ptr<const Armature> armature = context.document().armature;
  Keys keys = shown_clip(context.document())->keys;
  if (!delete_key(keys, *armature, chosen_bones(context), context.document().frame))
    return context.messages->info("Delete key", "The selected bones have no key at this frame");
  edit_clip(context, "Delete key", PoseThen::FromClip, [&](Clip& clip) { clip.keys = keys; });
}

void add_marker(Context& context) {
  const int frame = shown_frame(context);
  edit_clip(context, "Add marker", PoseThen::Stays, [&](Clip& clip) {
    const auto place = std::lower_bound(clip.markers.begin(), clip.markers.end(), frame,
                                        [](const Marker& marker, int at) { return marker.frame < at; });
    clip.markers.insert(place, {frame, "F " + std::to_string(frame)});
  });
}

// Returns why commands for the timeline's keys cannot run now, or "" if they can. They cannot run while the graph
// editor hides these keys.
std::string needs_rows(const Context& context) {
  return context.timeline->shows_graph ? "The graph editor is shown: select keys in its curves" : needs_keys(context);
}
std::string needs_chosen_keys(const Context& context) {
  if (context.timeline->shows_graph) return needs_rows(context);
  return context.timeline->chosen.empty() ? "Select keys in the timeline first" : "";
}

void choose_keys(Context& context, bool all) {
  context.timeline->chosen = all ? frames_of(shown_clip(context.document())->keys) : std::set<int>{};
}

void delete_chosen_keys(Context& context) {
  const std::set<int> chosen = std::exchange(context.timeline->chosen, {});
  edit_clip(context, "Delete keys", PoseThen::FromClip, [&](Clip& clip) { delete_clip_keys(clip, chosen); });
}

// Sets the playing range to the frames from the first to the last selected key. If fewer than two keys are selected,
// sets the playing range to the frames that the timeline shows.
void range_of_chosen(Context& context) {
  const Timeline& timeline = *context.timeline;
  const bool keys = timeline.chosen.size() > 1;
  const int low = keys ? *timeline.chosen.begin() : static_cast<int>(std::ceil(timeline.window.low));
  const int high =
      keys ? *timeline.chosen.rbegin() : static_cast<int>(std::floor(timeline.window.low + timeline.window.count));
  edit_clip(context, "Set range", PoseThen::Stays, [&](Clip& clip) {
    clip.range_start = low;
    clip.range_end = std::max(low, high);
  });
}

void whole_range(Context& context) {
  edit_clip(context, "Reset range", PoseThen::Stays, [](Clip& clip) {
    const std::set<int> keys = frames_of(clip.keys);
    clip.range_start = clip.motion ? clip.start : keys.empty() ? Clip{}.range_start : *keys.begin();
    clip.range_end = clip.motion ? clip.end() : keys.empty() ? Clip{}.range_end : *keys.rbegin();
  });
}

// Returns the index of the last marker at or before the play head; nothing when every marker is after it.
std::optional<std::size_t> marker_here(const Context& context) {
  const Clip* clip = shown_clip(context.document());
  std::optional<std::size_t> found;
  for (std::size_t i = 0; clip && i < clip->markers.size() && clip->markers[i].frame <= shown_frame(context); ++i)
    found = i;
  return found;
}
std::string needs_marker(const Context& context) {
  return marker_here(context) ? "" : "There is no marker at or before this frame";
}

void ask_marker_name(Context& context) {
  const Marker marker = shown_clip(context.document())->markers[*marker_here(context)];
  context.dialogs->open(make_form({"Rename marker",
                                   "Changes the name of the marker at frame " + std::to_string(marker.frame) + ".",
                                   "Rename",
                                   {text_of("Name", "Name of the marker.", marker.name)},
                                   {},
                                   [marker](Context& c, const std::vector<FormField>& fields) {
                                     edit_clip(c, "Rename marker", PoseThen::Stays, [&](Clip& clip) {
                                       const auto found = std::find(clip.markers.begin(), clip.markers.end(), marker);
                                       if (found != clip.markers.end()) found->name = fields[0].text;
                                     });
                                   }}));
}

void ask_onion_frames(Context& context) {
  const auto& onion = context.timeline->onion;
  context.dialogs->open(make_form(
      {"Onion skin",
       "Shows the outline of the body at frames before and after the shown frame, as ghosts.",
       "Show",
       {number_of("Ghosts per side", "Number of ghosts before the shown frame, and the same number after it.",
                  onion.count, 1, 10, "%.0f"),
        number_of("Ghost spacing", "Number of frames from one ghost to the next.", onion.step, 1, 10'000, "%.0f")},
       {},
       [](Context& c, const std::vector<FormField>& fields) {
         auto& changed = c.timeline->onion;
         changed.count = static_cast<int>(std::round(fields[0].value));
         changed.step = static_cast<int>(std::round(fields[1].value));
         changed.on = true;
         c.ui->touch();
       }}));
}

void delete_marker(Context& context) {
  const std::size_t place = *marker_here(context);
  edit_clip(context, "Delete marker", PoseThen::Stays,
            [&](Clip& clip) { clip.markers.erase(clip.markers.begin() + static_cast<std::ptrdiff_t>(place)); });
}

// Zooms the timeline by the motion of the mouse wheel. The frame under the pointer keeps its position.
void zoom(Context& context) {
  Timeline& timeline = *context.timeline;
  const double low = timeline.window.low, count = timeline.window.count;
  const double about = frame_at(timeline, context.ui->input.pointer.x);
  const double fresh = std::clamp(count * std::pow(kZoomStep, -context.ui->input.wheel), kFewestFrames, kMostFrames);
  timeline.window.low = about - (about - low) * fresh / count;
  timeline.window.count = fresh;
}

Operator at_end(const char* id, const char* label, const char* icon, const char* description, AtEnd which) {
  return {id,
          label,
          icon,
          "Motion",
          description,
          [which](Context& c) {
            auto& mode = c.timeline->play.at_end;
            mode = mode == which ? AtEnd::Stop : which;
          },
          nullptr,
          [which](const Context& c) { return c.timeline->play.at_end == which; }};
}

}  // namespace

std::vector<Operator> motion_operators() {
  const auto playing = [](int direction) {
    return [direction](const Context& c) { return c.timeline->play.on && c.timeline->play.direction == direction; };
  };
  return {
      {"motion.play", "Play", icon::kPlay, "Motion", "Play the clip at its own rate, or stop.",
       [](Context& c) { toggle_play(c, 1); }, needs_clip, playing(1)},
      {"motion.play_reverse", "Play backwards", icon::kBack, "Motion",
       "Play the clip from its end to its beginning, or stop.", [](Context& c) { toggle_play(c, -1); }, needs_clip,
       playing(-1)},
      {"motion.frame_back", "Frame back", icon::kBack, "Motion", "Go to the previous frame.",
       [](Context& c) { step(c, -1); }, needs_clip},
      {"motion.frame_forward", "Frame forward", icon::kForward, "Motion", "Go to the next frame.",
       [](Context& c) { step(c, 1); }, needs_clip},
      {"motion.frame_step", "Step through frames", "", "Motion", "Step from frame to frame with the mouse wheel.",
       [](Context& c) { step(c, c.ui->input.wheel < 0 ? 1 : -1); }, needs_clip},
      {"motion.first", "First frame", icon::kFirst, "Motion", "Go to the first frame of the playing range.",
       [](Context& c) { go(c, playing_range(c.document()).low); }, needs_clip},
      {"motion.last", "Last frame", icon::kLast, "Motion", "Go to the last frame of the playing range.",
       [](Context& c) { go(c, playing_range(c.document()).high); }, needs_clip},
      {"motion.next_key", "Next key", "", "Motion", "Go to the next frame that has a key.",
       [](Context& c) { go_to_key(c, 1); }, needs_keys},
      {"motion.previous_key", "Previous key", "", "Motion", "Go to the previous frame that has a key.",
       [](Context& c) { go_to_key(c, -1); }, needs_keys},
      {"motion.scrub", "Scrub", "", "Motion",
       "Show the frame under the pointer while the button is held. On a key, select and move the key.", press_timeline,
       needs_clip},
      {"motion.pan", "Pan the timeline", "", "Motion", "Drag to scroll the timeline.", pan_timeline},
      {"motion.zoom", "Zoom the timeline", "", "Motion", "Show fewer or more frames around the pointer.", zoom},
      {"motion.view_all", "Show all frames", "", "Motion", "Fit the whole clip into the timeline.",
       [](Context& c) { fit_window(c); }, needs_clip},
      {"motion.view_selected", "Show selected keys", "", "Motion", "Fit the selected keys into the timeline.",
       fit_window_to_keys, needs_chosen_keys},
      {"motion.set_start", "Start range here", "", "Motion", "Start the playing range at this frame.",
       [](Context& c) { set_range(c, true); }, needs_clip},
      {"motion.set_end", "End range here", "", "Motion", "End the playing range at this frame.",
       [](Context& c) { set_range(c, false); }, needs_clip},
      at_end("motion.loop", "Loop", icon::kLoop, "Play from the start again at the end of the range.", AtEnd::Loop),
      at_end("motion.ping_pong", "Ping-pong", kPingPongIcon, "Reverse the direction at each end of the range.",
             AtEnd::PingPong),
      {"motion.faster", "Play faster", "", "Motion", "Play at the next higher speed.",
       [](Context& c) { change_speed(c, 1); }},
      {"motion.slower", "Play slower", "", "Motion", "Play at the next lower speed.",
       [](Context& c) { change_speed(c, -1); }},
      {"motion.play_at_file_rate", "Original speed", "", "Motion", "Play at the rate at which the motion was recorded.",
       [](Context& c) { change_speed(c, 0); }},
      {"motion.show_seconds", "Show seconds", "", "Motion", "Show seconds instead of frames in the timeline's ruler.",
       [](Context& c) { c.timeline->seconds = !c.timeline->seconds; }, nullptr,
       [](const Context& c) { return c.timeline->seconds; }},
      {"motion.insert_key", "Insert key", icon::kKey, "Motion",
       "Store the pose of the selected bones, or of all, as a key at this frame.", insert_key_here, needs_rig},
      {"motion.delete_key", "Delete key", "", "Motion",
       "Delete the key of the selected bones, or of all, at this frame.", delete_key_here,
       [](const Context& c) { return !needs_rig(c).empty() ? needs_rig(c) : needs_keys(c); }},
      {"motion.auto_key", "Auto-key", icon::kDot, "Motion",
       "Insert a key at the shown frame whenever the pose changes.",
       [](Context& c) { c.timeline->auto_key = !c.timeline->auto_key; }, nullptr,
       [](const Context& c) { return c.timeline->auto_key; }},
      {"motion.onion_skin", "Onion skin", icon::kOnionSkin, "Motion",
       "Show the outline of the body at frames before and after this one.",
       [](Context& c) { c.timeline->onion.on = !c.timeline->onion.on; }, nullptr,
       [](const Context& c) { return c.timeline->onion.on; }},
      {"motion.paths", "Motion paths", "", "Motion",
       "Show the line along which the tip of each selected bone moves, with its frames and keys.",
       [](Context& c) { c.timeline->paths.on = !c.timeline->paths.on; }, nullptr,
       [](const Context& c) { return c.timeline->paths.on; }},
      {"motion.onion_frames", "Onion frames...", "", "Motion",
       "Set the number of outlines that the onion skin shows, and the frames between them.", ask_onion_frames},
      {"motion.marker", "Add marker", icon::kMarker, "Motion", "Add a named marker at this frame.", add_marker,
       needs_clip},
      {"motion.rename_marker", "Rename marker...", "", "Motion",
       "Rename the marker at this frame, or the last one before it.", ask_marker_name, needs_marker},
      {"motion.delete_marker", "Delete marker", "", "Motion",
       "Delete the marker at this frame, or the last one before it.", delete_marker, needs_marker},
      {"motion.box_keys", "Box select keys", "", "Motion", "Select the keys inside a rectangle that you draw.",
       box_keys, needs_rows},
      {"motion.choose_all_keys", "Select all keys", "", "Motion", "Select every key of the clip.",
       [](Context& c) { choose_keys(c, true); }, needs_rows},
      {"motion.choose_no_keys", "Deselect keys", "", "Motion", "Deselect all keys of the clip.",
       [](Context& c) { choose_keys(c, false); }, needs_chosen_keys},
      {"motion.move_keys", "Move keys", icon::kMove, "Motion",
       "Move the selected keys with the pointer, or by a typed number of frames.",
       [](Context& c) { begin_changing_keys(c, KeyChange::Move); }, needs_chosen_keys},
      {"motion.scale_keys", "Scale keys", icon::kScale, "Motion",
       "Move the selected keys towards the play head or away from it by a factor.",
       [](Context& c) { begin_changing_keys(c, KeyChange::Scale); }, needs_chosen_keys},
      {"motion.duplicate_keys", "Duplicate keys", icon::kDuplicate, "Motion",
       "Copy the selected keys and move the copies with the pointer.",
       [](Context& c) { begin_changing_keys(c, KeyChange::Duplicate); }, needs_chosen_keys},
      {"motion.delete_keys", "Delete keys", icon::kTrash, "Motion", "Delete the selected keys.", delete_chosen_keys,
       needs_chosen_keys},
      {"motion.key_menu", "Key menu", "", "Motion", "Open a menu at the pointer with the commands for keys.",
       [](Context& c) { c.menus->open_popup = "Keys"; }, needs_rig},
      {"motion.preview_range", "Range from keys", "", "Motion",
       "Set the playing range from the first to the last selected key, or to the frames that the timeline shows if no "
       "key is selected.",
       range_of_chosen, needs_clip},
      {"motion.clear_range", "Reset range", "", "Motion", "Set the playing range to the whole clip.", whole_range,
       needs_clip},
  };
}

}  // namespace limber::editor
