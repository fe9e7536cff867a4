// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/strips.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "core/base/error.h"
#include "core/motion/clip.h"

namespace limber {

namespace {

constexpr double kRounding = 2e-6;  // frames; smaller differences count as rounding errors

double eased(double share) { return share * share * (3 - 2 * share); }

// Returns whether `later`, which begins where `earlier` ends, continues the same clip at the same frame and with the
// same settings.
bool goes_on_with(const Strip& earlier, const Strip& later, double rate) {
  if (earlier.clip != later.clip || earlier.speed != later.speed || earlier.reversed != later.reversed ||
      earlier.mirrored != later.mirrored || earlier.goes_on != later.goes_on || earlier.blend != later.blend ||
      earlier.blend_out != 0 || later.blend_in != 0 || earlier.bones != later.bones || earlier.place != later.place)
    return false;
  const double passed = earlier.skip + (double(later.start) - earlier.start) * frames_per_frame(earlier, rate);
  if (earlier.first == later.first && earlier.last == later.last) return std::abs(passed - later.skip) < kRounding;
  // The strips use different ranges of the clip's frames. They continue each other only within one cycle.
  if (earlier.reversed || earlier.blend == StripBlend::AddChange) return false;
  return std::abs(earlier.first + passed - later.first - later.skip) < kRounding &&
         passed < earlier.last - earlier.first + kRounding && later.skip < later.last - later.first + kRounding;
}

// Finds the first strip and the end of each run (strips that play as one), and which strips are continued by another
// one.
void find_runs(const StripTrack& track, double rate, std::vector<StripRun>& runs) {
  std::multimap<int, std::size_t> ending;  // by end frame, the strips so far that no other strip continues
  for (std::size_t i = 0; i < track.strips.size(); ++i) {
    const Strip& strip = track.strips[i];
    const int end = end_of(strip, rate);
    runs[i] = {.head = i, .start = strip.start, .end = end};
    if (strip.muted) continue;
    const auto [low, high] = ending.equal_range(strip.start);
    const auto before =
        std::find_if(low, high, [&](const auto& one) { return goes_on_with(track.strips[one.second], strip, rate); });
    if (before != high) {
      const std::size_t head = runs[before->second].head;
      runs[before->second].has_next = true;
      runs[i].head = head;
      runs[head].end = end;
      ending.erase(before);
    }
    if (end > strip.start) ending.emplace(end, i);
  }
}

}  // namespace

double frames_of_cycles(const Strip& strip) { return strip.repeat * (double(strip.last) - strip.first); }

bool begins_within(const Strip& strip) {
  const double frames = frames_of_cycles(strip);
  return strip.skip >= 0 && strip.skip <= frames + 1e-9 * frames + kRounding;
}

void require_within_limits(const Strips& strips) {
  std::size_t count = 0;
  for (const StripTrack& track : strips.tracks) {
    count += track.strips.size();
    for (const Strip& strip : track.strips) {
      for (const int frame : {strip.start, strip.first, strip.last})
        if (std::abs(std::int64_t{frame}) > kMostStripFrame)
          throw Error("the strip lies too far from frame 0", strip.name,
                      "keep the strip within " + std::to_string(kMostStripFrame) + " frames of frame 0");
      if (!begins_within(strip))
        throw Error("the strip begins after the end of its clip", strip.name, "let the strip play more frames");
      for (const glm::dvec3& place : {strip.place.from, strip.place.to})
        for (int axis = 0; axis < 3; ++axis)
          if (!(std::abs(place[axis]) <= kFarthestMove))
            throw Error("the strip moves the body too far away", strip.name, "keep its positions within 10 km");
    }
  }
  if (count > kMostStrips)
    throw Error("a clip keeps at most " + std::to_string(kMostStrips) + " strips", std::to_string(count) + " strips",
                "bake some strips to a clip");
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
  const double frames = frames_of_cycles(strip) - strip.skip;
  // 1e-6 frames are added, so that rounding errors do not cut off the last frame.
  const double length = std::floor(frames / frames_per_frame(strip, rate) + 1e-6);
  return static_cast<int>(std::min(double(kMostStripFrame), strip.start + std::max(0.0, length)));
}

std::vector<StripRun> runs_of(const StripTrack& track, double rate) {
  std::vector<StripRun> runs(track.strips.size());
  find_runs(track, rate, runs);
  for (std::size_t i = 0; i < runs.size(); ++i) {  // the end of a run is known only after find_runs()
    runs[i].start = runs[runs[i].head].start;
    runs[i].end = runs[runs[i].head].end;
    if (!runs[i].has_next) runs[runs[i].head].fade_out = track.strips[i].blend_out;
  }
  std::int64_t latest = std::int64_t{-4} * kMostStripFrame;  // largest end frame of the runs before this one
  for (std::size_t i = 0; i < runs.size(); ++i) {
    StripRun& run = runs[i];
    const Strip& head = track.strips[run.head];
    if (run.head != i) {
      run.fade_in = runs[run.head].fade_in;
      run.fade_out = runs[run.head].fade_out;
      continue;
    }
    run.fade_in = head.blend_in;
    const int length = run.end - run.start;
    if (head.blend == StripBlend::Replace && latest > run.end) {
      if (run.fade_in == 0) run.fade_in = length / 2;
      if (run.fade_out == 0) run.fade_out = length - length / 2;
    } else if (head.blend == StripBlend::Replace && latest > run.start) {
      run.fade_in = std::max(run.fade_in, static_cast<int>(latest - run.start));
    }
    if (!head.muted) latest = std::max<std::int64_t>(latest, run.end);
  }
  return runs;
}

double share_at(const StripRun& run, int frame) {
  const auto part = [](double passed, int frames) {
    return frames <= 0 ? 1.0 : eased(std::clamp(passed / frames, 0.0, 1.0));
  };
  return part(double(frame) - run.start, run.fade_in) * part(double(run.end) - frame, run.fade_out);
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
