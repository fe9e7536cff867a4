// SPDX-License-Identifier: AGPL-3.0-or-later
// Repeats a take: the last frame of each repeat is the first frame of the next one.
#pragma once

#include <string>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

struct LoopSettings {
  int repeats = 2;
  int blend = 0;       // frames over which a seam is blended, half of them on each side of it
  bool stays = false;  // true: the body stays on the spot, and its heading comes back
};

struct LoopedPoses {
  std::vector<Pose> poses;  // repeats * (n - 1) + 1 for a take of n poses
  // The largest turn of a bone from the last pose of the take to its first, which the seam closes, and that bone.
  double gap_degrees = 0;
  std::string gap_bone;
  // How many times as fast as in the same frames of the take a bone turns at most where the seam is blended. Bones that
  // turn by less than a tenth of a degree per frame do not count.
  double haste = 1;
};

// Returns the poses repeated. Each repeat begins at the place on the ground and with the heading at which the one
// before ended. In the frames near a seam every bone is turned, and the body shifted, by a correction that begins with
// zero and ends half way to the other side's pose and speed, so that both sides meet. Every repeat is corrected at both
// ends, so the result can be repeated further.
// Throws Error for fewer than three poses, fewer than one repeat, more than a million frames, a blend longer than a
// repeat, or a rig with several root bones.
LoopedPoses looped(const Armature& armature, const std::vector<Pose>& poses, const LoopSettings& settings);

}  // namespace limber
