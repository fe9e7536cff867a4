// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/strips.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/base/error.h"
#include "core/motion/clip.h"

namespace limber {

namespace {

double eased(double share) { return share * share * (3 - 2 * share); }

}  // namespace

void require_within_limits(const Strips& strips) {
  std::size_t count = 0;
  for (const StripTrack& track : strips.tracks) {
    count += track.strips.size();
    for (const Strip& strip : track.strips) {
      for (const int frame : {strip.start, strip.first, strip.last})
        if (std::abs(std::int64_t{frame}) > kMostStripFrame)
          throw Error("the strip begins too far away", strip.name,
                      "keep it within " + std::to_string(kMostStripFrame) + " frames of frame 0");
      for (const glm::dvec3& place : {strip.place.from, strip.place.to})
        for (int axis = 0; axis < 3; ++axis)
          if (!(std::abs(place[axis]) <= kFarthestMove))
            throw Error("the strip lies too far away", strip.name, "place it within 10 km");
    }
  }
  if (count > kMostStrips)
    throw Error("a clip keeps at most " + std::to_string(kMostStrips) + " strips", std::to_string(count) + " strips",
                "bake some of them to a clip");
  if (strips.tracks.size() > kMostTracks)
    throw Error("a clip keeps at most " + std::to_string(kMostTracks) + " tracks",
                std::to_string(strips.tracks.size()) + " tracks", "put strips that do not overlap on one track");
}

std::vector<std::shared_ptr<const Clip>> clips_of(const Strips& strips) {
  std::vector<std::shared_ptr<const Clip>> clips;
  for (const StripTrack& track : strips.tracks)
    for (const Strip& strip : track.strips)
      if (std::find(clips.begin(), clips.end(), strip.clip) == clips.end()) clips.push_back(strip.clip);
  return clips;
}

double frames_per_frame(const Strip& strip, double rate) { return strip.speed * (strip.clip->rate / rate); }

int end_of(const Strip& strip, double rate) {
  const double frames = strip.repeat * (strip.last - strip.first) - strip.skip;
  // 1e-6 frames are added, so that rounding errors do not cut off the last frame.
  const double length = std::floor(frames / frames_per_frame(strip, rate) + 1e-6);
  return static_cast<int>(std::min(double(kMostStripFrame), strip.start + std::max(0.0, length)));
}

int fade_in_of(const StripTrack& track, std::size_t index, double rate) {
  const Strip& strip = track.strips[index];
  int overlap = 0;
  if (strip.blend == StripBlend::Replace)
    for (std::size_t i = 0; i < index; ++i)
      if (!track.strips[i].muted) overlap = std::max(overlap, end_of(track.strips[i], rate) - strip.start);
  return std::max(strip.blend_in, std::min(overlap, end_of(strip, rate) - strip.start));
}

double share_at(const Strip& strip, int fade_in, int end, int frame) {
  const auto part = [](double passed, int frames) {
    return frames <= 0 ? 1.0 : eased(std::clamp(passed / frames, 0.0, 1.0));
  };
  return part(double(frame) - strip.start, fade_in) * part(double(end) - frame, strip.blend_out);
}

bool plays(const Strips& strips, std::size_t track) {
  const bool any_solo =
      std::any_of(strips.tracks.begin(), strips.tracks.end(), [](const StripTrack& one) { return one.solo; });
  return !strips.tracks[track].muted && (!any_solo || strips.tracks[track].solo);
}

std::optional<StripSpan> span_of(const Strips& strips, double rate) {
  std::optional<StripSpan> span;
  for (const StripTrack& track : strips.tracks)
    for (const Strip& strip : track.strips) {
      const int end = end_of(strip, rate);
      if (!span) span = {strip.start, end};
      span->first = std::min(span->first, strip.start);
      span->last = std::max(span->last, end);
    }
  return span;
}

}  // namespace limber
