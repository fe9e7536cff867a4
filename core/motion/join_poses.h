// SPDX-License-Identifier: AGPL-3.0-or-later
// Joins two takes of one rig by a cross-fade from the last frames of the first to the first frames of the second.
#pragma once

#include <vector>

#include "core/motion/plants.h"

namespace limber {

struct JoinSettings {
  int fade = 1;             // frames in which both takes play, at least 1
  bool keeps_feet = false;  // true: feet that stand in the cross-fade stay in place
  double ease = 0.15;       // seconds over which a foot moves to its position and away from it
};

struct JoinedPoses {
  std::vector<Pose> poses;    // the joined poses: as many as both takes have, minus those of the cross-fade
  int fade_first = 0;         // frame at which the cross-fade, and the second take, begins
  std::vector<Plant> plants;  // plants of the feet that are kept in place
  // Largest distance, mm, that a foot slides because it stands in both takes at positions too far apart to be joined.
  double foot_gap = 0;
};

// Returns the joined takes. The second take is moved along the ground and turned about the vertical, so that its first
// frame has the position and heading of the first take's frame at which the cross-fade begins. With keeps_feet, a foot
// that stands in both takes at the middle of the cross-fade, at positions less than a seventh of its leg apart, keeps
// its position of the first take for as long as it stands in the second, and the second take is shifted to match.
//   rate  frames per second, of both takes
// Throws Error for a cross-fade that is longer than a take, for a rig with several root bones, and as planted() does.
JoinedPoses joined(const Armature& armature, const std::vector<PlantedLimb>& limbs, const std::vector<Pose>& first,
                   const std::vector<Pose>& second, double rate, const JoinSettings& settings);

}  // namespace limber
