// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/timeline.h"

#include <algorithm>
#include <cmath>

#include "core/motion/strips.h"
#include "core/project/history.h"
#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/interaction.h"
#include "editor/motion/constrained_pose.h"
#include "editor/shown/shown_pose.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

constexpr double kWindowRate = 60;  // playing is reported as slow only if fewer frames than this are drawn per second

std::shared_ptr<const Clip> clip_part(const Document& document) {
  return document.clips.empty() ? nullptr : document.clips[static_cast<std::size_t>(document.clip)];
}

std::shared_ptr<const Pose> pose_part(const Armature& armature, Pose pose) {
  return pose == rest_pose(armature) ? nullptr : std::make_shared<const Pose>(std::move(pose));
}

// Returns whether the clip moves the rig, by a retargeted motion, by strips, by keys or by constraints.
bool moves(const ClipOnRig& clip) { return clip.has_base() || !clip.clip()->keys.empty() || clip.constraints(); }

// Returns the frame to show after a playing time. Frames are counted from the start of the playing range: 0 to count -
// 1. Returns nothing when the clip has played to the end of the range and stops there.
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

void count_picture(Context& context) {
  auto& play = context.timeline->play;
  ++play.pictures;
  const double passed = context.ui->now - play.counted_since;
  if (passed < 1) return;
  const double wanted = std::min(frame_rate(context.document()) * play.speed, kWindowRate);
  const double shown = play.pictures / passed;
  play.pictures_per_second = shown < 0.9 * wanted ? shown : 0;
  play.pictures = 0;
  play.counted_since = context.ui->now;
}

}  // namespace

const Clip* shown_clip(const Document& document) { return document.shown_clip(); }

int shown_frame(const Context& context) { return context.timeline->frame.value_or(context.document().frame); }

FrameRange playing_range(const Document& document) {
  const Clip* clip = shown_clip(document);
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

double frame_rate(const Document& document) { return shown_clip(document) ? shown_clip(document)->rate : Clip{}.rate; }

const ClipOnRig* clip_on_rig(Context& context) {
  auto& prepared = context.timeline->prepared;
  const std::shared_ptr<const Clip> clip = clip_part(context.document());
  const std::shared_ptr<const Armature> armature = context.document().armature;
  if (!clip || !armature) prepared.reset();
  else if (!prepared || prepared->clip() != clip || prepared->armature() != armature)
    prepared = std::make_unique<ClipOnRig>(clip, armature, prepared.get());
  return prepared.get();
}

void show_frame(Context& context, int frame) {
  context.timeline->frame = frame;
  const ClipOnRig* clip = clip_on_rig(context);
  // At the document's frame the views show the document's pose, not the clip's, because the user may have changed the
  // document's pose.
  if (frame == context.document().frame && !context.timeline->play.on) drop_shown_pose(context);
  else if (clip && moves(*clip)) show_pose(context, clip->at(frame));
  context.ui->touch();
}

void settle_frame(Context& context) {
  Timeline& timeline = *context.timeline;
  if (!timeline.frame) return;
  Document next = context.document();
  next.frame = *timeline.frame;
  if (const ClipOnRig* clip = clip_on_rig(context); clip && moves(*clip))
    next.pose = pose_part(*next.armature, clip->at(next.frame));
  drop_frame(context);
  if (next.frame == context.document().frame) return;
  const std::string label = "Frame " + std::to_string(next.frame);
  if (timeline.revision == context.history->revision()) context.history->amend(label, std::move(next));
  else context.history->commit(label, std::move(next));
  timeline.revision = context.history->revision();
}

void drop_frame(Context& context) {
  if (!context.timeline->frame) return;
  context.timeline->frame.reset();
  drop_shown_pose(context);
}

void go_to_frame(Context& context, int frame) {
  show_frame(context, frame);
  settle_frame(context);
}

void play(Context& context, int direction) {
  auto& play = context.timeline->play;
  const FrameRange range = playing_range(context.document());
  int from = shown_frame(context);
  const int begin = direction > 0 ? range.low : range.high, end = direction > 0 ? range.high : range.low;
  if (from < range.low || from > range.high || (from == end && play.at_end == AtEnd::Stop)) from = begin;
  play.on = true;
  play.direction = direction;
  play.since = play.counted_since = context.ui->now;
  play.from = from;
  play.pictures = 0;
  play.pictures_per_second = 0;
  show_frame(context, from);
}

void stop_playing(Context& context) {
  if (!context.timeline->play.on) return;
  context.timeline->play.on = false;
  settle_frame(context);
  context.ui->touch();
}

void advance_time(Context& context) {
  Timeline& timeline = *context.timeline;
  if (!timeline.play.on) return;
  if (context.interaction->modal ||
      (context.interaction->drag && context.interaction->drag->button == MouseButton::Left))
    return stop_playing(context);
  const FrameRange range = playing_range(context.document());
  const auto& play = timeline.play;
  const bool forwards = play.direction > 0;
  const double begun = forwards ? play.from - range.low : range.high - play.from;
  // 1e-6 frames are added, so that rounding errors do not delay a frame that is due exactly now.
  const double passed = (context.ui->now - play.since) * frame_rate(context.document()) * play.speed + 1e-6;
  const auto step = frame_after(begun + passed, range.high - range.low + 1, play.at_end);
  if (!step) {
    timeline.frame = forwards ? range.high : range.low;
    return stop_playing(context);
  }
  const int frame = forwards ? range.low + *step : range.high - *step;
  if (timeline.frame != frame) {
    show_frame(context, frame);
    count_picture(context);
  }
}

void await_next_frame(Context& context) {
  const auto& play = context.timeline->play;
  if (!play.on) return;
  const double per_second = frame_rate(context.document()) * play.speed;
  const double passed = (context.ui->now - play.since) * per_second;
  context.ui->wake_at(play.since + (std::floor(passed + 1e-6) + 1) / per_second);
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

void edit_clip(Context& context, const std::string& label, PoseThen pose, const std::function<void(Clip&)>& edit) {
  settle_frame(context);
  Document next = context.document();
  const std::optional<Pose> free =
      pose == PoseThen::Stays && is_constrained(next) ? std::optional(unconstrained_pose(context)) : std::nullopt;
  if (next.clips.empty()) next.clips.push_back(std::make_shared<const Clip>(Clip{.name = "Keys"}));
  auto& shown = next.clips[static_cast<std::size_t>(next.clip)];
  Clip clip = *shown;
  edit(clip);
  if (clip.motion && (clip.start != shown->start || clip.end() != shown->end() || clip.rate != shown->rate)) {
    const FrameRange left = all_frames(clip);
    const double moment = shown->start + std::round((next.frame - shown->start) * clip.rate / shown->rate);
    next.frame = static_cast<int>(std::clamp<double>(moment, left.low, left.high));
    if (next.frame != moment)
      context.messages->info("The play head is at frame " + std::to_string(next.frame),
                             "The old frame is no longer in the clip");
  }
  shown = std::make_shared<const Clip>(std::move(clip));
  if (pose == PoseThen::FromClip) next.pose = pose_at_frame(next, &context.timeline->prepared);
  if (free) remember_free_pose(context.timeline, next, pose_of(next), *free);
  commit(context, label, std::move(next));
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
