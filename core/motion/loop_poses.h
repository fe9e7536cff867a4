// SPDX-License-Identifier: AGPL-3.0-or-later
// Repeats a take: the last frame of each repeat is the first frame of the next one.
#pragma once

#include <string>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

struct LoopSettings {
  int repeats = 2;
  int blend = 0;       // number of frames over which each seam is blended, half of them before and half after it
  bool stays = false;  // true: the body stays on the spot, and each repeat begins with the same heading
};

struct LoopedPoses {
  std::vector<Pose> poses;  // the repeats: repeats * (n - 1) + 1 poses for a take of n poses
  // The largest rotation of a bone from the last pose of the take to its first pose, degrees, and the name of that
  // bone. Closing the seam removes this gap.
  double gap_degrees = 0;
  std::string gap_bone;
  // The largest factor by which a bone turns faster in the blended frames than in the same frames of the original take.
  // Bones that turn by less than a tenth of a degree per frame do not count.
  double haste = 1;
};

// Returns the repeated poses. Each repeat begins at the ground position and with the heading at which the one before
// ended. In the frames near a seam every bone is rotated, and the body shifted, by a correction that is zero far from
// the seam. At the seam it is half of the difference between the two sides' poses and speeds, so that both sides join.
// Every repeat is corrected at both ends, so the result can be repeated further. Throws Error for fewer than three
// poses, fewer than one repeat, more than a million frames, a blend longer than a repeat, or a rig with several root
// bones.
LoopedPoses looped(const Armature& armature, const std::vector<Pose>& poses, const LoopSettings& settings);

}  // namespace limber
