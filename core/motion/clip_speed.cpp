// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/clip_speed.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "core/base/error.h"
#include "core/motion/motion_edit.h"
#include "core/motion/strip_edits.h"

namespace limber {

namespace {

// Largest frame number that a project can hold; a clip that would need a larger one is refused.
constexpr double kMostFrame = 1 << 28;
constexpr double kMostFrames = 1e6;  // a motion that would become longer than this, frames, is refused

void require_speed(double factor) {
  if (!(factor >= kSlowest && factor <= kFastest))
    throw Error("this speed cannot be used", std::to_string(factor) + " times as fast", "use a speed from 0.05 to 20");
}

void require_frames(double frames) {
  if (frames > kMostFrames)
    throw Error("the motion would become too long", std::to_string(static_cast<std::int64_t>(frames)) + " frames",
                "choose a higher speed");
}

// Gives the clip `ratio` times as many frames: resamples its motion, and multiplies the frames of keys and markers.
//   speed        the factor by which the clip plays faster
//   played_rate  frame rate at which the clip's motion is read, per second
//   rate         frame rate of the resampled motion, per second
void stretch(Clip& clip, double ratio, double speed, double played_rate, double rate, Progress& progress) {
  const auto moved = [&](int frame) {
    const double wanted = clip.start + std::round((double(frame) - clip.start) * ratio);
    if (std::abs(wanted) > kMostFrame)
      throw Error("the clip would become too long", clip.name, "choose a higher speed or a lower rate");
    return static_cast<int>(wanted);
  };
  std::map<int, int> frame_of;
  for (int frame : frames_of(clip.keys)) frame_of[frame] = moved(frame);
  move_keys(clip.keys, frame_of);
  scale_tangents(clip.keys, 1 / ratio);
  for (Marker& marker : clip.markers) marker.frame = moved(marker.frame);
  const bool plays_to_end = clip.motion && clip.range_end == clip.end();
  clip.range_start = moved(clip.range_start);
  clip.range_end = moved(clip.range_end);
  if (clip.strips) clip.strips = std::make_shared<const Strips>(rescaled_strips(*clip.strips, moved, ratio, speed));
  if (!clip.motion) return;
  Motion played = *clip.motion;
  played.frame_time = 1 / played_rate;
  clip.motion = std::make_shared<const Motion>(resampled(played, rate, progress));
  const int most = std::max(0, clip.motion->frame_count - 1);
  clip.first = std::clamp(static_cast<int>(std::round(clip.first * ratio)), 0, most);
  clip.last = std::clamp(static_cast<int>(std::round(clip.last * ratio)), clip.first, most);
  // The end of the range was rounded separately, so it may differ from clip.end() by one frame.
  if (plays_to_end) clip.range_end = clip.end();
}

}  // namespace

Clip at_rate(const Clip& clip, double rate) {
  Clip changed = clip;
  stretch(changed, rate / clip.rate, 1, clip.rate, rate, no_progress());
  changed.rate = rate;
  return changed;
}

Clip at_speed(const Clip& clip, double factor, Progress& progress) {
  require_speed(factor);
  if (clip.motion) require_frames(clip.motion->frame_count / factor);
  Clip changed = clip;
  // Resampling accepts only rates in a limited range, so the rate is clamped here.
  const double rate = std::clamp(clip.rate, 1.0, 1000.0);
  stretch(changed, 1 / factor, factor, rate * factor, rate, progress);
  return changed;
}

std::vector<Pose> at_speed(const std::vector<Pose>& poses, double factor) {
  require_speed(factor);
  std::vector<Pose> out;
  if (poses.empty()) return out;
  require_frames(double(poses.size()) / factor);
  const int last = static_cast<int>(poses.size()) - 1;
  const int frames = static_cast<int>(std::floor(last / factor + 1e-6)) + 1;
  for (int frame = 0; frame < frames; ++frame) {
    const double place = std::min(frame * factor, double(last));
    const int before = std::min(static_cast<int>(place + 1e-9), last), after = std::min(before + 1, last);
    const double share = std::clamp(place - before, 0.0, 1.0);
    Pose pose = poses[before];
    for (std::size_t bone = 0; share > 0 && bone < pose.rotation.size(); ++bone)
      pose.rotation[bone] = glm::normalize(glm::slerp(pose.rotation[bone], poses[after].rotation[bone], share));
    pose.root_translation = glm::mix(pose.root_translation, poses[after].root_translation, share);
    out.push_back(std::move(pose));
  }
  return out;
}

}  // namespace limber
