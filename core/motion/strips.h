// SPDX-License-Identifier: AGPL-3.0-or-later
// Strips: clips that play one after another and over one another, as in the non-linear animation editors of Blender and
// other programs.
//
// A strip plays a part of a clip, beginning at a given frame: faster or slower, forwards or backwards, mirrored,
// several times, on all bones or on some. Strips lie on tracks. The pose of a frame is computed from the lowest track
// to the highest, and within a track from the earliest strip to the latest: each strip blends its pose over the result
// of the strips before it, weighted by its influence. In a frame in which no strip plays, the rig is at rest.
//
// Strips of one track that overlap cross-fade: the later one fades in while the earlier one still plays. A strip that
// also ends before the earlier one fades in over its first half and out over its second half. A strip with `holds`
// keeps its last pose after its end, below later strips of its track. Before the first strip of a track begins, its
// first pose is held if it has `holds`.
//
// Strips on one track play as one strip, with common fades, order and holding, if they play the same clip, touch, and
// the later one continues at the clip's frame at which the earlier one ends. Splitting a strip therefore does not
// change what it plays.
//
// Time is counted in frames of the clip that has the strips. If the clip of a strip has another frame rate, it keeps
// its duration in seconds, so the strip has another number of frames than its clip.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/motion/ground_move.h"

namespace limber {

struct Clip;

// How a strip changes the pose that the strips before it have made. Replace: bones turn towards the strip's rotations.
// Add: they are turned further by the strip's rotations from rest, about their own axes, and a strip at rest changes
// nothing. AddChange: they are turned further by the strip's rotations since its first frame.
enum class StripBlend : std::uint8_t { Replace, Add, AddChange };

struct Strip {
  std::string name;                  // unique among the strips of a clip
  std::shared_ptr<const Clip> clip;  // never null, and without strips of its own
  int start = 0;                     // frame at which the strip begins
  int first = 0, last = 0;  // frames of the clip that make one cycle of the strip, both included, first <= last
  // Number of frames of the clip that are skipped when the strip begins, counted in the order in which they play. It
  // may be longer than a cycle.
  double skip = 0;
  double speed = 1;       // 2 plays twice as fast, [kSlowest, kFastest] of core/motion/clip_speed.h
  double repeat = 1;      // number of cycles that have passed when the strip ends, (0, kMostRepeats]
  bool reversed = false;  // each cycle plays from `last` to `first`
  bool mirrored = false;  // left and right are swapped
  bool goes_on = true;    // each cycle begins at the position and heading at which the one before it ended
  bool holds = true;      // true: the last pose of the strip is held below later strips of its track
  bool muted = false;     // true: the strip does not play
  StripBlend blend = StripBlend::Replace;
  double influence = 1;             // weight of the strip's pose over the pose below it, [0, 1]
  int blend_in = 0, blend_out = 0;  // frames over which the influence grows at the start, and falls at the end
  std::optional<std::set<std::string>> bones;  // names of the bones that the strip changes; nothing: all bones
  GroundMove place;  // move along the ground that is applied to the body while the strip plays

  bool operator==(const Strip&) const = default;  // compares the pointer of the clip
};

struct StripTrack {
  std::string name;           // unique among the tracks
  bool muted = false;         // true: the strips of the track do not play
  bool solo = false;          // if any track is solo, only solo tracks play
  std::vector<Strip> strips;  // sorted by start

  bool operator==(const StripTrack&) const = default;
};

struct Strips {
  std::vector<StripTrack> tracks;  // from the lowest to the highest

  bool operator==(const Strips&) const = default;
};

// Returns the clips of the strips, each once, in the order of their first use.
std::vector<std::shared_ptr<const Clip>> clips_of(const Strips& strips);

constexpr double kMostRepeats = 10'000;
constexpr std::size_t kMostTracks = 256, kMostStrips = 4096;  // largest numbers in one clip
constexpr int kLongestBlend = 100'000;                        // longest fade of a strip, frames
constexpr std::int64_t kMostStripFrame = 1 << 28;             // largest frame number of a strip, either sign
constexpr double kFarthestMove = 1e7;  // largest coordinate of a strip's move along the ground, mm
// Returns how many frames of its clip have passed at the end of the strip, if the strip skips none at its beginning.
double frames_of_cycles(const Strip& strip);
// Returns whether the skipped frames end before the last cycle does, so that something is left to play. Rounding errors
// are tolerated.
bool begins_within(const Strip& strip);
// Throws Error for strips that a project file cannot store: too many strips or tracks, frames or positions that are too
// large, or a strip that would begin after its last cycle.
void require_within_limits(const Strips& strips);

// Returns how many frames of a strip's clip pass in one frame of the strip.
//   rate  frames per second of the clip that has the strips
double frames_per_frame(const Strip& strip, double rate);
// Returns the last frame at which the strip plays.
int end_of(const Strip& strip, double rate);

// A run: strips of one track that play as one, because each continues the one before it.
struct StripRun {
  std::size_t head = 0;           // index on the track of the run's first strip
  int start = 0, end = 0;         // first and last frame of the run
  int fade_in = 0, fade_out = 0;  // frames; from the strips' own fades or from an overlap with an earlier run
  bool has_next = false;          // true: another strip of the run follows this one
};
// Returns the run of each strip of the track.
std::vector<StripRun> runs_of(const StripTrack& track, double rate);
// Returns the weight that the fades give to a strip at a frame of its run, [0, 1]. It changes smoothly.
double share_at(const StripRun& run, int frame);
// Returns whether the track plays: it is not muted, and it is solo if any track is.
bool plays(const Strips& strips, std::size_t track);

// The frames from the first start to the last end of the strips; nothing if there are none.
struct StripSpan {
  int first = 0, last = 0;
};
std::optional<StripSpan> span_of(const Strips& strips, double rate);

}  // namespace limber
