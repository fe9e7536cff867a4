// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of the timeline: playing, stepping, scrubbing, the playing range, keys, markers and the onion skin.
#include <algorithm>
#include <cmath>

#include "core/motion/clip_keys.h"
#include "editor/context/operator_polls.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/motion/constrained_pose.h"
#include "editor/motion/timeline_tool.h"
#include "editor/shown/shown_pose.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

constexpr char kPingPongIcon[] = "\uf07e";
constexpr double kSpeeds[] = {0.1, 0.25, 0.5, 1, 2, 4};
// Zoom factor per wheel step; zooming out stops at this many frames.
constexpr double kZoomStep = 1.25, kMostFrames = 1e7;

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
  const Pose pose = unconstrained_pose(editor);
  const int frame = editor.document().frame;
  const std::shared_ptr<const Armature> armature = editor.document().armature;
  const auto insert = [&](Clip& clip) { insert_key(clip.keys, *armature, pose, bones, frame); };
  if (is_constrained(editor.document())) change_free_clip(editor, "Insert key", insert);
  else edit_clip(editor, "Insert key", PoseThen::Stays, insert);
}

void delete_key_here(Editor& editor) {
  settle_frame(editor);
  const std::shared_ptr<const Armature> armature = editor.document().armature;
  Keys keys = shown_clip(editor)->keys;
  if (!delete_key(keys, *armature, chosen_bones(editor), editor.document().frame))
    return editor.messages.info("Delete key", "The selected bones have no key at this frame");
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

// Returns why commands for the timeline's keys cannot run now, or "" if they can. They cannot run while the graph
// editor hides these keys.
std::string needs_rows(const Editor& editor) {
  return editor.timeline->shows_graph ? "The graph editor is shown: select keys in its curves" : needs_keys(editor);
}
std::string needs_chosen_keys(const Editor& editor) {
  if (editor.timeline->shows_graph) return needs_rows(editor);
  return editor.timeline->chosen.empty() ? "Select keys in the timeline first" : "";
}

void choose_keys(Editor& editor, bool all) {
  editor.timeline->chosen = all ? frames_of(shown_clip(editor)->keys) : std::set<int>{};
}

void delete_chosen_keys(Editor& editor) {
  const std::set<int> chosen = std::exchange(editor.timeline->chosen, {});
  edit_clip(editor, "Delete keys", PoseThen::FromClip, [&](Clip& clip) { delete_clip_keys(clip, chosen); });
}

// Sets the playing range from the first to the last selected key. When fewer than two keys are selected, sets it to the
// frames that the timeline shows.
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
  edit_clip(editor, "Reset range", PoseThen::Stays, [](Clip& clip) {
    const std::set<int> keys = frames_of(clip.keys);
    clip.range_start = clip.motion ? clip.start : keys.empty() ? Clip{}.range_start : *keys.begin();
    clip.range_end = clip.motion ? clip.end() : keys.empty() ? Clip{}.range_end : *keys.rbegin();
  });
}

// Returns the index of the last marker at or before the play head; nothing when every marker is after it.
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
                                "Changes the name of the marker at frame " + std::to_string(marker.frame) + ".",
                                "Rename",
                                {text_of("Name", "Name of the marker.", marker.name)},
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
  editor.open_dialog(make_form(
      {"Onion skin",
       "Shows the outline of the body at frames before and after the shown frame, as ghosts.",
       "Show",
       {number_of("Ghosts per side", "Number of ghosts before the shown frame, and the same number after it.",
                  onion.count, 1, 10, "%.0f"),
        number_of("Ghost spacing", "Number of frames from one ghost to the next.", onion.step, 1, 10'000, "%.0f")},
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

// Zooms the timeline by the motion of the mouse wheel. The frame under the pointer keeps its position.
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
      {"motion.play", "Play", icon::kPlay, "Motion", "Play the clip at its own rate, or stop.",
       [](Editor& e) { toggle_play(e, 1); }, needs_clip, playing(1)},
      {"motion.play_reverse", "Play backwards", icon::kBack, "Motion",
       "Play the clip from its end to its beginning, or stop.", [](Editor& e) { toggle_play(e, -1); }, needs_clip,
       playing(-1)},
      {"motion.frame_back", "Frame back", icon::kBack, "Motion", "Go to the previous frame.",
       [](Editor& e) { step(e, -1); }, needs_clip},
      {"motion.frame_forward", "Frame forward", icon::kForward, "Motion", "Go to the next frame.",
       [](Editor& e) { step(e, 1); }, needs_clip},
      {"motion.frame_step", "Step through frames", "", "Motion", "Step from frame to frame with the mouse wheel.",
       [](Editor& e) { step(e, e.input.wheel < 0 ? 1 : -1); }, needs_clip},
      {"motion.first", "First frame", icon::kFirst, "Motion", "Go to the first frame of the playing range.",
       [](Editor& e) { go(e, playing_range(e).low); }, needs_clip},
      {"motion.last", "Last frame", icon::kLast, "Motion", "Go to the last frame of the playing range.",
       [](Editor& e) { go(e, playing_range(e).high); }, needs_clip},
      {"motion.next_key", "Next key", "", "Motion", "Go to the next frame that has a key.",
       [](Editor& e) { go_to_key(e, 1); }, needs_keys},
      {"motion.previous_key", "Previous key", "", "Motion", "Go to the previous frame that has a key.",
       [](Editor& e) { go_to_key(e, -1); }, needs_keys},
      {"motion.scrub", "Scrub", "", "Motion",
       "Show the frame under the pointer while the button is held. On a key, select and move the key.", press_timeline,
       needs_clip},
      {"motion.pan", "Pan the timeline", "", "Motion", "Drag to scroll the timeline.", pan_timeline},
      {"motion.zoom", "Zoom the timeline", "", "Motion", "Show fewer or more frames around the pointer.", zoom},
      {"motion.view_all", "Show all frames", "", "Motion", "Fit the whole clip into the timeline.",
       [](Editor& e) { fit_window(e); }, needs_clip},
      {"motion.view_selected", "Show selected keys", "", "Motion", "Fit the selected keys into the timeline.",
       fit_window_to_keys, needs_chosen_keys},
      {"motion.set_start", "Start range here", "", "Motion", "Start the playing range at this frame.",
       [](Editor& e) { set_range(e, true); }, needs_clip},
      {"motion.set_end", "End range here", "", "Motion", "End the playing range at this frame.",
       [](Editor& e) { set_range(e, false); }, needs_clip},
      at_end("motion.loop", "Loop", icon::kLoop, "Play from the start again at the end of the range.", AtEnd::Loop),
      at_end("motion.ping_pong", "Ping-pong", kPingPongIcon, "Reverse the direction at each end of the range.",
             AtEnd::PingPong),
      {"motion.faster", "Play faster", "", "Motion", "Play at the next higher speed.",
       [](Editor& e) { change_speed(e, 1); }},
      {"motion.slower", "Play slower", "", "Motion", "Play at the next lower speed.",
       [](Editor& e) { change_speed(e, -1); }},
      {"motion.play_at_file_rate", "Original speed", "", "Motion", "Play at the rate at which the motion was recorded.",
       [](Editor& e) { change_speed(e, 0); }},
      {"motion.show_seconds", "Show seconds", "", "Motion", "Show seconds instead of frames in the timeline's ruler.",
       [](Editor& e) { e.timeline->seconds = !e.timeline->seconds; }, nullptr,
       [](const Editor& e) { return e.timeline->seconds; }},
      {"motion.insert_key", "Insert key", icon::kKey, "Motion",
       "Store the pose of the selected bones, or of all, as a key at this frame.", insert_key_here, needs_rig},
      {"motion.delete_key", "Delete key", "", "Motion",
       "Delete the key of the selected bones, or of all, at this frame.", delete_key_here,
       [](const Editor& e) { return !needs_rig(e).empty() ? needs_rig(e) : needs_keys(e); }},
      {"motion.auto_key", "Auto-key", icon::kDot, "Motion",
       "Insert a key at the shown frame whenever the pose changes.",
       [](Editor& e) { e.timeline->auto_key = !e.timeline->auto_key; }, nullptr,
       [](const Editor& e) { return e.timeline->auto_key; }},
      {"motion.onion_skin", "Onion skin", icon::kOnionSkin, "Motion",
       "Show the outline of the body at frames before and after this one.",
       [](Editor& e) { e.timeline->onion.on = !e.timeline->onion.on; }, nullptr,
       [](const Editor& e) { return e.timeline->onion.on; }},
      {"motion.paths", "Motion paths", "", "Motion",
       "Show the line along which the tip of each selected bone moves, with its frames and keys.",
       [](Editor& e) { e.timeline->paths.on = !e.timeline->paths.on; }, nullptr,
       [](const Editor& e) { return e.timeline->paths.on; }},
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
       [](Editor& e) { choose_keys(e, true); }, needs_rows},
      {"motion.choose_no_keys", "Deselect keys", "", "Motion", "Deselect all keys of the clip.",
       [](Editor& e) { choose_keys(e, false); }, needs_chosen_keys},
      {"motion.move_keys", "Move keys", icon::kMove, "Motion",
       "Move the selected keys with the pointer, or by a typed number of frames.",
       [](Editor& e) { begin_changing_keys(e, KeyChange::Move); }, needs_chosen_keys},
      {"motion.scale_keys", "Scale keys", icon::kScale, "Motion",
       "Move the selected keys towards the play head or away from it by a factor.",
       [](Editor& e) { begin_changing_keys(e, KeyChange::Scale); }, needs_chosen_keys},
      {"motion.duplicate_keys", "Duplicate keys", icon::kDuplicate, "Motion",
       "Copy the selected keys and move the copies with the pointer.",
       [](Editor& e) { begin_changing_keys(e, KeyChange::Duplicate); }, needs_chosen_keys},
      {"motion.delete_keys", "Delete keys", icon::kTrash, "Motion", "Delete the selected keys.", delete_chosen_keys,
       needs_chosen_keys},
      {"motion.key_menu", "Key menu", "", "Motion", "Open a menu at the pointer with the commands for keys.",
       [](Editor& e) { e.open_popup = "Keys"; }, needs_rig},
      {"motion.preview_range", "Range from keys", "", "Motion",
       "Set the playing range from the first to the last selected key, or to the frames that the timeline shows if no "
       "key is selected.",
       range_of_chosen, needs_clip},
      {"motion.clear_range", "Reset range", "", "Motion", "Set the playing range to the whole clip.", whole_range,
       needs_clip},
  };
}

}  // namespace limber::editor
