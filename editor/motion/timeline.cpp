// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/timeline.h"

#include <algorithm>
#include <cmath>

#include "core/motion/strips.h"
#include "editor/context/document_edits.h"
#include "editor/motion/constrained_pose.h"
#include "editor/shown/shown_pose.h"

namespace limber::editor {

namespace {

constexpr double kWindowRate = 60;  // at this drawing rate or above, playing is not reported as slow, frames per second

std::shared_ptr<const Clip> clip_part(const Document& document) {
  return document.clips.empty() ? nullptr : document.clips[static_cast<std::size_t>(document.clip)];
}

std::shared_ptr<const Pose> pose_part(const Armature& armature, Pose pose) {
  return pose == rest_pose(armature) ? nullptr : std::make_shared<const Pose>(std::move(pose));
}

// Returns whether the clip moves the rig, by a retargeted motion, by strips, by keys or by constraints.
bool moves(const ClipOnRig& clip) { return clip.has_base() || !clip.clip()->keys.empty() || clip.constraints(); }

// Returns the frame to show after a playing time, counted from the start of the playing range: 0 to count - 1. Returns
// nothing when the clip has played to the end of the range and stops there.
//   frames  playing time since the start of the range, in frames
//   count   number of frames of the range
std::optional<int> frame_after(double frames, int count, AtEnd at_end) {
  const double step = std::floor(frames);
  if (step < count) return static_cast<int>(std::max(0.0, step));
  if (at_end == AtEnd::Stop) return std::nullopt;
  if (at_end == AtEnd::Loop) return static_cast<int>(std::fmod(step, count));
  const int turn = std::max(1, 2 * (count - 1)), place = static_cast<int>(std::fmod(step, turn));
  return place < count ? place : turn - place;
}

void count_picture(Editor& editor) {
  auto& play = editor.timeline->play;
  ++play.pictures;
  const double passed = editor.now - play.counted_since;
  if (passed < 1) return;
  const double wanted = std::min(frame_rate(editor) * play.speed, kWindowRate);
  const double shown = play.pictures / passed;
  play.pictures_per_second = shown < 0.9 * wanted ? shown : 0;
  play.pictures = 0;
  play.counted_since = editor.now;
}

}  // namespace

const Clip* shown_clip(const Editor& editor) { return editor.document().shown_clip(); }

int shown_frame(const Editor& editor) { return editor.timeline->frame.value_or(editor.document().frame); }

FrameRange playing_range(const Editor& editor) {
  const Clip* clip = shown_clip(editor);
  const FrameRange range =
      clip ? FrameRange{clip->range_start, clip->range_end} : FrameRange{Clip{}.range_start, Clip{}.range_end};
  return {range.low, std::max(range.low, range.high)};
}

FrameRange all_frames(const Clip& clip) {
  FrameRange all{clip.range_start, std::max(clip.range_start, clip.range_end)};
  const auto take = [&](int frame) { all = {std::min(all.low, frame), std::max(all.high, frame)}; };
  if (clip.motion) take(clip.start), take(clip.end());
  if (clip.strips)
    if (const auto span = span_of(*clip.strips, clip.rate)) take(span->first), take(span->last);
  for (const int frame : frames_of(clip.keys)) take(frame);
  for (const Marker& marker : clip.markers) take(marker.frame);
  return all;
}

double frame_rate(const Editor& editor) { return shown_clip(editor) ? shown_clip(editor)->rate : Clip{}.rate; }

const ClipOnRig* clip_on_rig(Editor& editor) {
  auto& prepared = editor.timeline->prepared;
  const std::shared_ptr<const Clip> clip = clip_part(editor.document());
  const std::shared_ptr<const Armature> armature = editor.document().armature;
  if (!clip || !armature) prepared.reset();
  else if (!prepared || prepared->clip() != clip || prepared->armature() != armature)
    prepared = std::make_unique<ClipOnRig>(clip, armature, prepared.get());
  return prepared.get();
}

void show_frame(Editor& editor, int frame) {
  editor.timeline->frame = frame;
  const ClipOnRig* clip = clip_on_rig(editor);
  // At the document's frame the views show the document's pose, not the clip's, because the user may have changed the
  // document's pose.
  if (frame == editor.document().frame && !editor.timeline->play.on) drop_shown_pose(editor);
  else if (clip && moves(*clip)) show_pose(editor, clip->at(frame));
  editor.touch();
}

void settle_frame(Editor& editor) {
  Timeline& timeline = *editor.timeline;
  if (!timeline.frame) return;
  Document next = editor.document();
  next.frame = *timeline.frame;
  if (const ClipOnRig* clip = clip_on_rig(editor); clip && moves(*clip))
    next.pose = pose_part(*next.armature, clip->at(next.frame));
  drop_frame(editor);
  if (next.frame == editor.document().frame) return;
  const std::string label = "Frame " + std::to_string(next.frame);
  if (timeline.revision == editor.history.revision()) editor.history.amend(label, std::move(next));
  else editor.history.commit(label, std::move(next));
  timeline.revision = editor.history.revision();
}

void drop_frame(Editor& editor) {
  if (!editor.timeline->frame) return;
  editor.timeline->frame.reset();
  drop_shown_pose(editor);
}

void go_to_frame(Editor& editor, int frame) {
  show_frame(editor, frame);
  settle_frame(editor);
}

void play(Editor& editor, int direction) {
  auto& play = editor.timeline->play;
  const FrameRange range = playing_range(editor);
  int from = shown_frame(editor);
  const int begin = direction > 0 ? range.low : range.high, end = direction > 0 ? range.high : range.low;
  if (from < range.low || from > range.high || (from == end && play.at_end == AtEnd::Stop)) from = begin;
  play.on = true;
  play.direction = direction;
  play.since = play.counted_since = editor.now;
  play.from = from;
  play.pictures = 0;
  play.pictures_per_second = 0;
  show_frame(editor, from);
}

void stop_playing(Editor& editor) {
  if (!editor.timeline->play.on) return;
  editor.timeline->play.on = false;
  settle_frame(editor);
  editor.touch();
}

void advance_time(Editor& editor) {
  Timeline& timeline = *editor.timeline;
  if (!timeline.play.on) return;
  if (editor.modal || (editor.drag && editor.drag->button == MouseButton::Left)) return stop_playing(editor);
  const FrameRange range = playing_range(editor);
  const auto& play = timeline.play;
  const bool forwards = play.direction > 0;
  const double begun = forwards ? play.from - range.low : range.high - play.from;
  // 1e-6 frames are added, so that rounding errors do not delay a frame that is due exactly now.
  const double passed = (editor.now - play.since) * frame_rate(editor) * play.speed + 1e-6;
  const auto step = frame_after(begun + passed, range.high - range.low + 1, play.at_end);
  if (!step) {
    timeline.frame = forwards ? range.high : range.low;
    return stop_playing(editor);
  }
  const int frame = forwards ? range.low + *step : range.high - *step;
  if (timeline.frame != frame) {
    show_frame(editor, frame);
    count_picture(editor);
  }
}

void await_next_frame(Editor& editor) {
  const auto& play = editor.timeline->play;
  if (!play.on) return;
  const double per_second = frame_rate(editor) * play.speed;
  const double passed = (editor.now - play.since) * per_second;
  editor.wake_at(play.since + (std::floor(passed + 1e-6) + 1) / per_second);
}

std::shared_ptr<const Pose> pose_at_frame(const Document& document, std::unique_ptr<ClipOnRig>* prepared) {
  const std::shared_ptr<const Clip> clip = clip_part(document);
  const bool fits =
      document.pose && document.armature && document.pose->rotation.size() == document.armature->bones.size();
  if (!document.armature) return nullptr;
  if (!clip) return fits ? document.pose : nullptr;
  auto on_rig = std::make_unique<ClipOnRig>(clip, document.armature, prepared ? prepared->get() : nullptr);
  const std::shared_ptr<const Pose> from_clip = moves(*on_rig)
                                                    ? pose_part(*document.armature, on_rig->at(document.frame))
                                                : fits ? document.pose
                                                       : nullptr;
  if (prepared) *prepared = std::move(on_rig);
  return from_clip;
}

void add_clip(Document& document, Clip clip) {
  clip.name = unique_clip_name(document.clips, clip.name);
  document.frame = clip.start;
  document.clips.push_back(std::make_shared<const Clip>(std::move(clip)));
  document.clip = static_cast<int>(document.clips.size()) - 1;
  document.pose = pose_at_frame(document);
}

void edit_clip(Editor& editor, const std::string& label, PoseThen pose, const std::function<void(Clip&)>& edit) {
  settle_frame(editor);
  Document next = editor.document();
  const std::optional<Pose> free =
      pose == PoseThen::Stays && is_constrained(next) ? std::optional(unconstrained_pose(editor)) : std::nullopt;
  if (next.clips.empty()) next.clips.push_back(std::make_shared<const Clip>(Clip{.name = "Keys"}));
  auto& shown = next.clips[static_cast<std::size_t>(next.clip)];
  Clip clip = *shown;
  edit(clip);
  if (clip.motion && (clip.start != shown->start || clip.end() != shown->end() || clip.rate != shown->rate)) {
    const FrameRange left = all_frames(clip);
    const double moment = shown->start + std::round((next.frame - shown->start) * clip.rate / shown->rate);
    next.frame = static_cast<int>(std::clamp<double>(moment, left.low, left.high));
    if (next.frame != moment)
      editor.messages.info("The play head is at frame " + std::to_string(next.frame),
                           "Its old frame is no longer in the clip");
  }
  shown = std::make_shared<const Clip>(std::move(clip));
  if (pose == PoseThen::FromClip) next.pose = pose_at_frame(next, &editor.timeline->prepared);
  if (free) remember_free_pose(editor, next, pose_of(next), *free);
  commit(editor, label, std::move(next));
}

void key_changes(Document& document, const Pose& before, const Pose& pose) {
  if (document.clips.empty()) document.clips.push_back(std::make_shared<const Clip>(Clip{.name = "Keys"}));
  auto& shown = document.clips[static_cast<std::size_t>(document.clip)];
  Clip clip = *shown;
  std::vector<int> changed;
  for (int bone = 0; bone < std::ssize(pose.rotation); ++bone)
    if (pose.rotation[bone] != before.rotation[bone] ||
        (document.armature->bones[bone].parent < 0 && pose.root_translation != before.root_translation))
      changed.push_back(bone);
  insert_key(clip.keys, *document.armature, pose, changed, document.frame);
  shown = std::make_shared<const Clip>(std::move(clip));
}

}  // namespace limber::editor
