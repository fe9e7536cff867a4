// SPDX-License-Identifier: AGPL-3.0-or-later
// Through time: playing, stepping, scrubbing, the range, keys and markers.
#include <algorithm>
#include <cmath>

#include "editor/context/operator_polls.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/motion/timeline.h"
#include "editor/motion/timeline_tool.h"
#include "editor/shown/shown_pose.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

constexpr char kPingPongIcon[] = "\uf07e";
constexpr double kSpeeds[] = {0.1, 0.25, 0.5, 1, 2, 4};
constexpr double kZoomStep = 1.25, kMostFrames = 1e7;  // seen at once

std::string needs_clip(const Editor& editor) {
  return shown_clip(editor) ? "" : "Import a motion first, or insert a key";
}
std::string needs_rig(const Editor& editor) { return editor.document().armature ? "" : "Import a rig first"; }
std::string needs_keys(const Editor& editor) {
  const Clip* clip = shown_clip(editor);
  return clip && !clip->keys.empty() ? "" : "There are no keys yet";
}

void toggle_play(Editor& editor, int direction) {
  const auto& playing = editor.timeline->play;
  if (playing.on && playing.direction == direction) return stop_playing(editor);
  play(editor, direction);
}

void step(Editor& editor, int frames) {
  const bool was_playing = editor.timeline->play.on;
  stop_playing(editor);
  if (!was_playing || std::abs(frames) > 1) go_to_frame(editor, shown_frame(editor) + frames);
}

void go(Editor& editor, int frame) {
  stop_playing(editor);
  go_to_frame(editor, frame);
}

void go_to_key(Editor& editor, int direction) {
  const std::set<int> frames = frames_of(shown_clip(editor)->keys);
  const int now = shown_frame(editor);
  if (direction > 0) {
    const auto next = frames.upper_bound(now);
    if (next != frames.end()) go(editor, *next);
  } else if (const auto next = frames.lower_bound(now); next != frames.begin()) {
    go(editor, *std::prev(next));
  }
}

void set_range(Editor& editor, bool start) {
  const int frame = shown_frame(editor);
  edit_clip(editor, start ? "Set start of range" : "Set end of range", PoseThen::Stays, [&](Clip& clip) {
    (start ? clip.range_start : clip.range_end) = frame;
    if (clip.range_start > clip.range_end) (start ? clip.range_end : clip.range_start) = frame;
  });
}

void change_speed(Editor& editor, int by) {
  auto& playing = editor.timeline->play;
  const int count = static_cast<int>(std::size(kSpeeds));
  int place = 0;
  while (place + 1 < count && kSpeeds[place] < playing.speed) ++place;
  const double speed = by == 0 ? 1 : kSpeeds[std::clamp(place + by, 0, count - 1)];
  playing.from = shown_frame(editor);
  playing.since = editor.now;
  playing.speed = speed;
  playing.pictures_per_second = 0;
}

void insert_key_here(Editor& editor) {
  settle_frame(editor);
  const std::vector<int> bones = chosen_bones(editor);
  const Pose pose = pose_of(editor.document());
  const int frame = editor.document().frame;
  const std::shared_ptr<const Armature> armature = editor.document().armature;
  edit_clip(editor, "Insert key", PoseThen::Stays,
            [&](Clip& clip) { insert_key(clip.keys, *armature, pose, bones, frame); });
}

void delete_key_here(Editor& editor) {
  settle_frame(editor);
  const std::shared_ptr<const Armature> armature = editor.document().armature;
  Keys keys = shown_clip(editor)->keys;
  if (!delete_key(keys, *armature, chosen_bones(editor), editor.document().frame))
    return editor.messages.info("Delete key", "There is no key of these bones at this frame");
  edit_clip(editor, "Delete key", PoseThen::FromClip, [&](Clip& clip) { clip.keys = keys; });
}

void add_marker(Editor& editor) {
  const int frame = shown_frame(editor);
  edit_clip(editor, "Add marker", PoseThen::Stays, [&](Clip& clip) {
    const auto place = std::lower_bound(clip.markers.begin(), clip.markers.end(), frame,
                                        [](const Marker& marker, int at) { return marker.frame < at; });
    clip.markers.insert(place, {frame, "F " + std::to_string(frame)});
  });
}

std::string needs_chosen_keys(const Editor& editor) {
  return editor.timeline->chosen.empty() ? "Choose keys in the timeline first" : "";
}

void choose_keys(Editor& editor, bool all) {
  editor.timeline->chosen = all ? frames_of(shown_clip(editor)->keys) : std::set<int>{};
}

void delete_chosen_keys(Editor& editor) {
  const std::set<int> chosen = std::exchange(editor.timeline->chosen, {});
  edit_clip(editor, "Delete keys", PoseThen::FromClip, [&](Clip& clip) { delete_keys(clip.keys, chosen); });
}

// From the first to the last chosen key; what is seen of time where none is chosen.
void range_of_chosen(Editor& editor) {
  const Timeline& timeline = *editor.timeline;
  const bool keys = timeline.chosen.size() > 1;
  const int low = keys ? *timeline.chosen.begin() : static_cast<int>(std::ceil(timeline.window.low));
  const int high =
      keys ? *timeline.chosen.rbegin() : static_cast<int>(std::floor(timeline.window.low + timeline.window.count));
  edit_clip(editor, "Set range", PoseThen::Stays, [&](Clip& clip) {
    clip.range_start = low;
    clip.range_end = std::max(low, high);
  });
}

void whole_range(Editor& editor) {
  edit_clip(editor, "Whole range", PoseThen::Stays, [](Clip& clip) {
    const std::set<int> keys = frames_of(clip.keys);
    clip.range_start = clip.motion ? clip.start : keys.empty() ? Clip{}.range_start : *keys.begin();
    clip.range_end = clip.motion ? clip.end() : keys.empty() ? Clip{}.range_end : *keys.rbegin();
  });
}

// The marker at the play head, or the last one before it.
std::optional<std::size_t> marker_here(const Editor& editor) {
  const Clip* clip = shown_clip(editor);
  std::optional<std::size_t> found;
  for (std::size_t i = 0; clip && i < clip->markers.size() && clip->markers[i].frame <= shown_frame(editor); ++i)
    found = i;
  return found;
}
std::string needs_marker(const Editor& editor) {
  return marker_here(editor) ? "" : "There is no marker at or before this frame";
}

void ask_marker_name(Editor& editor) {
  const Marker marker = shown_clip(editor)->markers[*marker_here(editor)];
  editor.open_dialog(make_form({"Rename marker",
                                "Another name for the marker at frame " + std::to_string(marker.frame) + ".",
                                "Rename",
                                {text_of("Name", "What happens here.", marker.name)},
                                {},
                                [marker](Editor& e, const std::vector<FormField>& fields) {
                                  edit_clip(e, "Rename marker", PoseThen::Stays, [&](Clip& clip) {
                                    const auto found = std::find(clip.markers.begin(), clip.markers.end(), marker);
                                    if (found != clip.markers.end()) found->name = fields[0].text;
                                  });
                                }}));
}

void ask_onion_frames(Editor& editor) {
  const auto& onion = editor.timeline->onion;
  editor.open_dialog(make_form({"Onion skin",
                                "The skeleton at frames before and after the one that is shown.",
                                "Show",
                                {number_of("On either side", "So many ghosts.", onion.count, 1, 10, "%.0f"),
                                 number_of("Frames apart", "From one to the next.", onion.step, 1, 10'000, "%.0f")},
                                {},
                                [](Editor& e, const std::vector<FormField>& fields) {
                                  auto& changed = e.timeline->onion;
                                  changed.count = static_cast<int>(std::round(fields[0].value));
                                  changed.step = static_cast<int>(std::round(fields[1].value));
                                  changed.on = true;
                                  e.touch();
                                }}));
}

void delete_marker(Editor& editor) {
  const std::size_t place = *marker_here(editor);
  edit_clip(editor, "Delete marker", PoseThen::Stays,
            [&](Clip& clip) { clip.markers.erase(clip.markers.begin() + static_cast<std::ptrdiff_t>(place)); });
}

// About the frame under the pointer, or the play head.
void zoom(Editor& editor) {
  Timeline& timeline = *editor.timeline;
  const double low = timeline.window.low, count = timeline.window.count;
  const double about = frame_at(timeline, editor.input.pointer.x);
  const double fresh = std::clamp(count * std::pow(kZoomStep, -editor.input.wheel), kFewestFrames, kMostFrames);
  timeline.window.low = about - (about - low) * fresh / count;
  timeline.window.count = fresh;
}

Operator at_end(const char* id, const char* label, const char* icon, const char* description, AtEnd which) {
  return {id,
          label,
          icon,
          "Motion",
          description,
          [which](Editor& e) {
            auto& mode = e.timeline->play.at_end;
            mode = mode == which ? AtEnd::Stop : which;
          },
          nullptr,
          [which](const Editor& e) { return e.timeline->play.at_end == which; }};
}

}  // namespace

std::vector<Operator> motion_operators() {
  const auto playing = [](int direction) {
    return [direction](const Editor& e) { return e.timeline->play.on && e.timeline->play.direction == direction; };
  };
  return {
      {"motion.play", "Play", icon::kPlay, "Motion", "Plays the clip at its own rate, or stops.",
       [](Editor& e) { toggle_play(e, 1); }, needs_clip, playing(1)},
      {"motion.play_reverse", "Play backwards", icon::kBack, "Motion",
       "Plays the clip from its end to its beginning, or stops.", [](Editor& e) { toggle_play(e, -1); }, needs_clip,
       playing(-1)},
      {"motion.frame_back", "Frame back", icon::kBack, "Motion", "Goes to the frame before.",
       [](Editor& e) { step(e, -1); }, needs_clip},
      {"motion.frame_forward", "Frame forward", icon::kForward, "Motion", "Goes to the next frame.",
       [](Editor& e) { step(e, 1); }, needs_clip},
      {"motion.frame_step", "Turn through frames", "", "Motion", "The wheel goes from frame to frame.",
       [](Editor& e) { step(e, e.input.wheel < 0 ? 1 : -1); }, needs_clip},
      {"motion.first", "First frame", icon::kFirst, "Motion", "Goes to the beginning of the range.",
       [](Editor& e) { go(e, playing_range(e).low); }, needs_clip},
      {"motion.last", "Last frame", icon::kLast, "Motion", "Goes to the end of the range.",
       [](Editor& e) { go(e, playing_range(e).high); }, needs_clip},
      {"motion.next_key", "Next key", "", "Motion", "Goes to the next frame that has a key.",
       [](Editor& e) { go_to_key(e, 1); }, needs_keys},
      {"motion.previous_key", "Previous key", "", "Motion", "Goes to the frame before that has a key.",
       [](Editor& e) { go_to_key(e, -1); }, needs_keys},
      {"motion.scrub", "Scrub", "", "Motion",
       "Shows the frame under the pointer as long as it is held; on a key, chooses and moves that.", press_timeline,
       needs_clip},
      {"motion.pan", "Pan the timeline", "", "Motion", "Moves what is seen of time.", pan_timeline},
      {"motion.zoom", "Zoom the timeline", "", "Motion", "Shows fewer or more frames, about the pointer.", zoom},
      {"motion.view_all", "Show all frames", "", "Motion", "The whole clip fits into the timeline.",
       [](Editor& e) { fit_window(e); }, needs_clip},
      {"motion.view_selected", "Show chosen keys", "", "Motion", "The chosen keys fit into the timeline.",
       fit_window_to_keys, needs_chosen_keys},
      {"motion.set_start", "Start range here", "", "Motion", "What plays begins at this frame.",
       [](Editor& e) { set_range(e, true); }, needs_clip},
      {"motion.set_end", "End range here", "", "Motion", "What plays ends at this frame.",
       [](Editor& e) { set_range(e, false); }, needs_clip},
      at_end("motion.loop", "Loop", icon::kLoop, "Begins again where the range ends.", AtEnd::Loop),
      at_end("motion.ping_pong", "Ping-pong", kPingPongIcon, "Turns round where the range ends.", AtEnd::PingPong),
      {"motion.faster", "Faster", "", "Motion", "Plays at the next higher speed.",
       [](Editor& e) { change_speed(e, 1); }},
      {"motion.slower", "Slower", "", "Motion", "Plays at the next lower speed.",
       [](Editor& e) { change_speed(e, -1); }},
      {"motion.play_at_file_rate", "Speed of the file", "", "Motion", "Plays at the rate at which it was recorded.",
       [](Editor& e) { change_speed(e, 0); }},
      {"motion.show_seconds", "Seconds", "", "Motion", "The ruler counts seconds in place of frames.",
       [](Editor& e) { e.timeline->seconds = !e.timeline->seconds; }, nullptr,
       [](const Editor& e) { return e.timeline->seconds; }},
      {"motion.insert_key", "Insert key", icon::kKey, "Motion",
       "Keeps the pose of the chosen bones, or of all, at this frame.", insert_key_here, needs_rig},
      {"motion.delete_key", "Delete key", "", "Motion",
       "Takes away the key of the chosen bones, or of all, at this frame.", delete_key_here,
       [](const Editor& e) { return !needs_rig(e).empty() ? needs_rig(e) : needs_keys(e); }},
      {"motion.auto_key", "Auto-key", icon::kDot, "Motion", "Every change of the pose becomes a key at its frame.",
       [](Editor& e) { e.timeline->auto_key = !e.timeline->auto_key; }, nullptr,
       [](const Editor& e) { return e.timeline->auto_key; }},
      {"motion.onion_skin", "Onion skin", icon::kOnionSkin, "Motion",
       "Shows the outline of the body at frames before and after this one.",
       [](Editor& e) { e.timeline->onion.on = !e.timeline->onion.on; }, nullptr,
       [](const Editor& e) { return e.timeline->onion.on; }},
      {"motion.onion_frames", "Onion frames...", "", "Motion", "How many ghosts there are, and how far apart.",
       ask_onion_frames},
      {"motion.marker", "Add marker", icon::kMarker, "Motion", "Puts a named mark at this frame.", add_marker,
       needs_clip},
      {"motion.rename_marker", "Rename marker...", "", "Motion",
       "Names the marker at this frame, or the last one before it.", ask_marker_name, needs_marker},
      {"motion.delete_marker", "Delete marker", "", "Motion",
       "Takes away the marker at this frame, or the last one before it.", delete_marker, needs_marker},
      {"motion.box_keys", "Choose keys by a box", "", "Motion", "Chooses the keys inside the rectangle that is drawn.",
       box_keys, needs_keys},
      {"motion.choose_all_keys", "Choose all keys", "", "Motion", "Chooses every key of the clip.",
       [](Editor& e) { choose_keys(e, true); }, needs_keys},
      {"motion.choose_no_keys", "Choose no keys", "", "Motion", "No key is chosen any more.",
       [](Editor& e) { choose_keys(e, false); }, needs_chosen_keys},
      {"motion.move_keys", "Move keys", icon::kMove, "Motion",
       "The chosen keys go with the pointer, or by a typed number of frames.",
       [](Editor& e) { begin_changing_keys(e, KeyChange::Move); }, needs_chosen_keys},
      {"motion.scale_keys", "Scale keys", icon::kScale, "Motion",
       "The chosen keys draw together or apart about the play head.",
       [](Editor& e) { begin_changing_keys(e, KeyChange::Scale); }, needs_chosen_keys},
      {"motion.duplicate_keys", "Duplicate keys", icon::kDuplicate, "Motion",
       "Copies of the chosen keys go with the pointer.",
       [](Editor& e) { begin_changing_keys(e, KeyChange::Duplicate); }, needs_chosen_keys},
      {"motion.delete_keys", "Delete keys", icon::kTrash, "Motion", "Takes away the chosen keys.", delete_chosen_keys,
       needs_chosen_keys},
      {"motion.key_menu", "Key menu", "", "Motion", "Lists what can be done with keys, at the pointer.",
       [](Editor& e) { e.open_popup = "Keys"; }, needs_rig},
      {"motion.preview_range", "Range of keys", "", "Motion",
       "What plays goes from the first to the last chosen key, or is what the timeline shows.", range_of_chosen,
       needs_clip},
      {"motion.clear_range", "Whole range", "", "Motion", "All of the clip plays.", whole_range, needs_clip},
  };
}

}  // namespace limber::editor
