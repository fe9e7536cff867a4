// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/moved_strips.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "core/motion/strip_edits.h"

namespace limber {

namespace {

constexpr std::int64_t kFarthest = 1 << 27;  // frames; a longer move is shortened to this

// Returns `wanted`, or the nearest number of tracks by which all strips move to tracks that exist.
int fitting_tracks(const Strips& strips, const std::set<std::string>& chosen, int wanted) {
  int low = static_cast<int>(strips.tracks.size()), high = 0;
  for (int t = 0; t < std::ssize(strips.tracks); ++t)
    for (const Strip& strip : strips.tracks[t].strips)
      if (chosen.contains(strip.name)) low = std::min(low, t), high = std::max(high, t);
  return std::clamp(wanted, -low, std::max(-low, static_cast<int>(strips.tracks.size()) - 1 - high));
}

}  // namespace

StripMove fitting_move(const Strips& strips, const std::set<std::string>& chosen, const StripMove& wanted, double rate,
                       Overlaps overlaps) {
  StripMove move = wanted;
  move.frames = static_cast<int>(std::clamp<std::int64_t>(move.frames, -kFarthest, kFarthest));
  move.tracks = fitting_tracks(strips, chosen, wanted.tracks);
  if (overlaps == Overlaps::Allowed) return move;
  // The moves, in frames, by which a moving strip would overlap a strip that stays on the moving strip's new track.
  struct Barred {
    std::int64_t low, high;  // the strips overlap if the move is between these two
  };
  std::vector<Barred> barred;
  for (int t = 0; t < std::ssize(strips.tracks); ++t)
    for (const Strip& strip : strips.tracks[t].strips) {
      const int to = t + move.tracks;
      if (!chosen.contains(strip.name) || to < 0 || to >= std::ssize(strips.tracks)) continue;
      for (const Strip& other : strips.tracks[to].strips) {
        if (chosen.contains(other.name)) continue;
        const Barred one{std::int64_t{other.start} - end_of(strip, rate),
                         std::int64_t{end_of(other, rate)} - strip.start};
        if (move.tracks != 0 || one.low >= 0 || one.high <= 0) barred.push_back(one);
      }
    }
  const auto fits = [&](std::int64_t frames) {
    return std::none_of(barred.begin(), barred.end(),
                        [&](const Barred& one) { return one.low < frames && frames < one.high; });
  };
  if (fits(move.frames)) return move;
  std::int64_t nearest = kFarthest;
  for (const Barred& one : barred)
    for (const std::int64_t frames : {one.low, one.high})
      if (fits(frames) && std::abs(frames - wanted.frames) < std::abs(nearest - wanted.frames)) nearest = frames;
  move.frames = static_cast<int>(nearest);
  return move;
}

Strips moved_strips(const Strips& strips, const std::set<std::string>& chosen, const StripMove& move) {
  Strips moved = strips;
  for (StripTrack& track : moved.tracks)
    std::erase_if(track.strips, [&](const Strip& strip) { return chosen.contains(strip.name); });
  for (std::size_t t = 0; t < strips.tracks.size(); ++t)
    for (Strip strip : strips.tracks[t].strips) {
      if (!chosen.contains(strip.name)) continue;
      strip.start += move.frames;
      insert_strip(moved.tracks[t + static_cast<std::size_t>(move.tracks)], std::move(strip));
    }
  return moved;
}

std::set<std::string> add_copies(Strips& strips, const std::set<std::string>& chosen) {
  std::set<std::string> copies;
  for (StripTrack& track : strips.tracks) {
    const std::vector<Strip> before = track.strips;
    for (Strip strip : before) {
      if (!chosen.contains(strip.name)) continue;
      strip.name = unique_strip_name(strips, strip.name);
      copies.insert(strip.name);
      insert_strip(track, std::move(strip));
    }
  }
  return copies;
}

}  // namespace limber
