// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits strips (core/motion/strips.h): makes them from clips, trims, splits and mirrors them, moves them to where the
// body is, and scales them in time.
#pragma once

#include <functional>
#include <utility>

#include "core/motion/strips.h"
#include "core/rig/armature.h"

namespace limber {

// Returns a strip that plays the frames of the clip's playing range once. Its name is unique among the strips.
Strip strip_of(std::shared_ptr<const Clip> clip, const Strips& among, int start);
// Returns the name `wanted`, with a number appended if a strip, or a track, has this name already.
std::string unique_strip_name(const Strips& strips, const std::string& wanted);
std::string unique_track_name(const Strips& strips, const std::string& wanted);

// Where a strip is found: the index of its track, and its index on this track. find_strip() returns nothing if no strip
// has the name.
struct StripPlace {
  std::size_t track = 0, index = 0;

  bool operator==(const StripPlace&) const = default;
};
std::optional<StripPlace> find_strip(const Strips& strips, const std::string& name);
// Inserts a strip so that the track's strips stay sorted by start.
void insert_strip(StripTrack& track, Strip strip);
void sort_strips(StripTrack& track);
// Returns whether no strip of the track plays between the frames `first` and `last`. A strip that ends at `first`, or
// begins at `last`, does not count.
bool has_room(const StripTrack& track, int first, int last, double rate);

// Return the strip with another start or end. At frames that both the old and the new strip cover, they play the same
// poses, bit for bit if the strip plays whole frames of its clip. The new strip keeps at least one frame of its clip.
// It can be extended only as far as its clip has frames; its end can also be extended by repeats, up to kMostRepeats.
Strip with_start(const Strip& strip, int frame, double rate);
Strip with_end(const Strip& strip, int frame, double rate);
// Splits the strip at a frame. The second part begins at this frame and gets the name `second_name`. While the two
// parts touch, together they play as the strip did. Throws Error if the frame does not lie inside the strip.
std::pair<Strip, Strip> split(const Strip& strip, int frame, double rate, const std::string& second_name);

// Returns the horizontal move and turn after which the strip's first pose has the horizontal position and the heading
// that the other strips give the body at that frame. Throws Error for a rig with several root bones.
GroundMove place_where_body_is(const Strips& strips, const StripPlace& place,
                               const std::shared_ptr<const Armature>& armature, double rate);

// Returns strips that play the mirrored poses.
Strips mirrored_strips(const Strips& strips, const Armature& armature);
// Returns the strip changed so that it plays the same part of its clip after the clip's frames were renumbered.
//   frame_of  returns the new number of a frame of the clip
//   ratio     new number of the clip's frames divided by the old one
Strip with_clip_frames(const Strip& strip, const std::function<int(int)>& frame_of, double ratio);
// Returns the strips with starts and fades moved to new frame numbers. Throws Error if the speed of a strip would leave
// its allowed range.
//   frame_of  returns the new number of a frame
//   ratio     factor on the lengths of the fades
//   speed     factor on the speeds of the strips
Strips rescaled_strips(const Strips& strips, const std::function<int(int)>& frame_of, double ratio, double speed);

}  // namespace limber
