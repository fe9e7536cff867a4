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

// The position of a strip: its track, and its index on the track. find_strip() returns nothing if no strip has the
// name.
struct StripPlace {
  std::size_t track = 0, index = 0;

  bool operator==(const StripPlace&) const = default;
};
std::optional<StripPlace> find_strip(const Strips& strips, const std::string& name);
// Inserts a strip so that the track's strips stay sorted by start.
void insert_strip(StripTrack& track, Strip strip);
void sort_strips(StripTrack& track);
// Returns whether no strip of the track plays between the frames first and last. A strip that ends at `first`, or
// begins at `last`, does not count.
bool has_room(const StripTrack& track, int first, int last, double rate);

// Returns the strip with another start or end. At the frames that it keeps it plays the same poses, bit for bit if it
// plays whole frames of its clip. It keeps at least one frame of its clip. It becomes longer only as far as its clip
// has frames, or at the end until it has the most repeats.
Strip with_start(const Strip& strip, int frame, double rate);
Strip with_end(const Strip& strip, int frame, double rate);
// Returns the strip in two: the second begins at the frame and keeps the name `second_name`. Together they play as it
// did while they touch. Throws Error if the frame is not inside.
std::pair<Strip, Strip> split(const Strip& strip, int frame, double rate, const std::string& second_name);

// Returns the move along the ground after which the strip begins with the position and heading that the body has at the
// strip's start without the strip. Throws Error for a rig with several root bones.
GroundMove place_where_body_is(const Strips& strips, const StripPlace& place,
                               const std::shared_ptr<const Armature>& armature, double rate);

// Returns strips that play the mirrored poses.
Strips mirrored_strips(const Strips& strips, const Armature& armature);
// Returns the strip that plays the same of its clip when that has other frames.
//   frame_of  returns the new frame of a frame of the clip
//   ratio     how many frames a frame of the clip becomes
Strip with_clip_frames(const Strip& strip, const std::function<int(int)>& frame_of, double ratio);
// Returns strips whose starts and fades are those at other frames. Throws Error for a strip whose speed would leave its
// range.
//   frame_of  returns the new frame of a frame
//   ratio     factor of the lengths of the fades
//   speed     factor of the speeds of the strips
Strips rescaled_strips(const Strips& strips, const std::function<int(int)>& frame_of, double ratio, double speed);

}  // namespace limber
