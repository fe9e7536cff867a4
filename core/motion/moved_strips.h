// SPDX-License-Identifier: AGPL-3.0-or-later
// Moves strips in time and from track to track, and copies them.
#pragma once

#include <map>
#include <set>
#include <string>

#include "core/motion/strips.h"

namespace limber {

struct StripMove {
  int frames = 0;  // number of frames by which the strips move later; negative: earlier
  int tracks = 0;  // number of tracks by which the strips move up; negative: down

  bool operator==(const StripMove&) const = default;
};

// Returns the move nearest to the wanted one that moves the strips only to tracks that exist. With Overlaps::Avoided,
// the moved strips also overlap no strip that stays; strips that overlap already may go on overlapping while they keep
// their track.
//   chosen  names of the strips that move
//   rate    frames per second of the clip that has the strips
enum class Overlaps { Allowed, Avoided };
StripMove fitting_move(const Strips& strips, const std::set<std::string>& chosen, const StripMove& wanted, double rate,
                       Overlaps overlaps);

// Returns the strips after a move. The tracks to which it moves strips must exist.
Strips moved_strips(const Strips& strips, const std::set<std::string>& chosen, const StripMove& move);

// Adds copies of strips to their tracks. Returns the names of the copies.
std::set<std::string> add_copies(Strips& strips, const std::set<std::string>& chosen);

}  // namespace limber
