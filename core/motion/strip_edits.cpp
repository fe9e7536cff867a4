// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/strip_edits.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "core/motion/clip_speed.h"
#include "core/motion/strips_on_rig.h"
#include "core/rig/mirror.h"

namespace limber {

namespace {

template <class Taken>
std::string unique_name(const std::string& wanted, const Taken& taken) {
  std::string name = wanted;
  for (int number = 2; taken(name); ++number) name = wanted + " " + std::to_string(number);
  return name;
}

// Returns `number` as an integer if it is whole up to rounding errors and not beyond the frames that a strip can have.
// Else returns nothing.
std::optional<int> whole(double number) {
  const double nearest = std::round(number);
  if (!(std::abs(nearest) <= double(kMostStripFrame))) return std::nullopt;
  return std::abs(number - nearest) < 1e-6 ? std::optional(static_cast<int>(nearest)) : std::nullopt;
}

// Returns whether the strip plays its clip's frames once, forwards and from the first frame on. Such a strip can be
// trimmed by changing the first or last of these frames.
bool plays_once(const Strip& strip) {
  return strip.repeat == 1 && strip.skip == 0 && !strip.reversed && strip.blend != StripBlend::AddChange;
}

// Returns the range of frames that contains the clip's motion and its playing range.
StripSpan frames_of_clip(const Clip& clip) {
  StripSpan span{clip.range_start, std::max(clip.range_start, clip.range_end)};
  if (clip.motion) span = {std::min(span.first, clip.start), std::max(span.last, clip.end())};
  return span;
}

void drop_long_fades(Strip& strip, double rate) {
  const int length = end_of(strip, rate) - strip.start;
  strip.blend_in = std::min(strip.blend_in, length);
  strip.blend_out = std::min(strip.blend_out, length);
}

}  // namespace

Strip strip_of(std::shared_ptr<const Clip> clip, const Strips& among, int start) {
  Strip strip;
  strip.name = unique_strip_name(among, clip->name);
  strip.start = start;
  strip.first = clip->range_start;
  strip.last = std::max(clip->range_start, clip->range_end);
  strip.clip = std::move(clip);
  return strip;
}

std::string unique_strip_name(const Strips& strips, const std::string& wanted) {
  return unique_name(wanted, [&](const std::string& name) { return find_strip(strips, name).has_value(); });
}

std::string unique_track_name(const Strips& strips, const std::string& wanted) {
  return unique_name(wanted, [&](const std::string& name) {
    return std::any_of(strips.tracks.begin(), strips.tracks.end(),
                       [&](const StripTrack& track) { return track.name == name; });
  });
}

std::optional<StripPlace> find_strip(const Strips& strips, const std::string& name) {
  for (std::size_t t = 0; t < strips.tracks.size(); ++t)
    for (std::size_t i = 0; i < strips.tracks[t].strips.size(); ++i)
      if (strips.tracks[t].strips[i].name == name) return StripPlace{t, i};
  return std::nullopt;
}

void insert_strip(StripTrack& track, Strip strip) {
  track.strips.push_back(std::move(strip));
  sort_strips(track);
}

void sort_strips(StripTrack& track) {
  std::stable_sort(track.strips.begin(), track.strips.end(),
                   [](const Strip& a, const Strip& b) { return a.start < b.start; });
}

bool has_room(const StripTrack& track, int first, int last, double rate) {
  return std::none_of(track.strips.begin(), track.strips.end(),
                      [&](const Strip& strip) { return strip.start < last && end_of(strip, rate) > first; });
}

Strip with_start(const Strip& strip, int frame, double rate) {
  Strip changed = strip;
  const double ratio = frames_per_frame(strip, rate);
  const auto passed = whole((double(frame) - strip.start) * ratio);
  if (plays_once(strip) && passed) {
    changed.first = std::clamp(strip.first + *passed, std::min(strip.first, frames_of_clip(*strip.clip).first),
                               std::max(strip.first, strip.last - 1));
    changed.start = strip.start + static_cast<int>(std::round((changed.first - strip.first) / ratio));
  } else {
    const double far = std::max(-double(kMostStripFrame), strip.start - std::floor(strip.skip / ratio + 1e-6));
    const int earliest = static_cast<int>(far);
    changed.start = std::clamp(frame, earliest, std::max(earliest, end_of(strip, rate) - 1));
    changed.skip = std::max(0.0, strip.skip + (double(changed.start) - strip.start) * ratio);
  }
  drop_long_fades(changed, rate);
  return changed;
}

Strip with_end(const Strip& strip, int frame, double rate) {
  Strip changed = strip;
  const double ratio = frames_per_frame(strip, rate);
  const double passed = strip.skip + (std::max(frame, strip.start + 1) - double(strip.start)) * ratio;
  const double steps = double(strip.last) - strip.first;
  if (plays_once(strip) && whole(passed) && *whole(passed) >= 1)
    changed.last = static_cast<int>(std::clamp<std::int64_t>(std::int64_t{strip.first} + *whole(passed), strip.first,
                                                             std::max(strip.last, frames_of_clip(*strip.clip).last)));
  else if (steps > 0) changed.repeat = std::min(passed / steps, kMostRepeats);
  drop_long_fades(changed, rate);
  return changed;
}

std::pair<Strip, Strip> split(const Strip& strip, int frame, double rate, const std::string& second_name) {
  const int end = end_of(strip, rate);
  if (frame <= strip.start || frame > end)
    throw Error("the strip cannot be split at this frame", strip.name + ", frame " + std::to_string(frame),
                "choose a frame from " + std::to_string(strip.start + 1) + " to " + std::to_string(end));
  Strip left = strip, right = strip;
  const double ratio = frames_per_frame(strip, rate), passed = strip.skip + (double(frame) - strip.start) * ratio;
  const double steps = strip.last - strip.first;
  if (plays_once(strip) && whole(passed)) {
    left.last = strip.first + *whole(passed);
    right.first = left.last;
  } else {
    left.repeat = passed / steps;
    right.skip = passed;
  }
  right.start = frame;
  right.name = second_name;
  left.blend_out = right.blend_in = 0;
  return {left, right};
}

GroundMove place_where_body_is(const Strips& strips, const StripPlace& place,
                               const std::shared_ptr<const Armature>& armature, double rate) {
  Strip alone = strips.tracks[place.track].strips[place.index];
  const int frame = alone.start;
  auto without = std::make_shared<Strips>(strips);
  without->tracks[place.track].strips[place.index].muted = true;
  alone.blend = StripBlend::Replace;
  alone.influence = 1;
  alone.blend_in = alone.blend_out = 0;
  alone.bones = std::nullopt;
  alone.muted = false;
  alone.place = {};
  const auto only = std::make_shared<const Strips>(Strips{{{.name = "Only", .strips = {alone}}}});
  return move_to(*armature, StripsOnRig(only, armature, rate).at(frame),
                 StripsOnRig(without, armature, rate).at(frame));
}

Strips mirrored_strips(const Strips& strips, const Armature& armature) {
  const std::vector<int> pairs = mirror_pairs(armature);
  const MirrorPlane plane = mirror_plane(armature);
  Strips mirrored = strips;
  for (StripTrack& track : mirrored.tracks)
    for (Strip& strip : track.strips) {
      strip.mirrored = !strip.mirrored;
      strip.place = {-strip.place.turn, plane.place(strip.place.from), plane.place(strip.place.to)};
      if (!strip.bones) continue;
      std::set<std::string> bones;
      for (const std::string& name : *strip.bones) {
        const auto bone = armature.find(name);
        bones.insert(bone ? armature.bones[pairs[*bone]].name : name);
      }
      strip.bones = std::move(bones);
    }
  return mirrored;
}

Strip with_clip_frames(const Strip& strip, const std::function<int(int)>& frame_of, double ratio) {
  Strip changed = strip;
  changed.first = frame_of(strip.first);
  changed.last = std::max(changed.first, frame_of(strip.last));
  changed.skip = std::min(strip.skip * ratio, frames_of_cycles(changed));
  return changed;
}

Strips rescaled_strips(const Strips& strips, const std::function<int(int)>& frame_of, double ratio, double speed) {
  Strips scaled = strips;
  for (StripTrack& track : scaled.tracks) {
    for (Strip& strip : track.strips) {
      strip.start = frame_of(strip.start);
      strip.speed *= speed;
      if (!(strip.speed >= kSlowest && strip.speed <= kFastest))
        throw Error(strip.speed < kSlowest ? "the strip would play too slowly" : "the strip would play too fast",
                    strip.name,
                    "choose another speed, or first change the strip's own speed: a strip plays 0.05 to 20 times as "
                    "fast as its clip");
      for (int* frames : {&strip.blend_in, &strip.blend_out})
        *frames = static_cast<int>(std::clamp<double>(std::round(*frames * ratio), 0, kLongestBlend));
    }
    sort_strips(track);
  }
  return scaled;
}

}  // namespace limber
