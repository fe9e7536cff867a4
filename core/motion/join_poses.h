// SPDX-License-Identifier: AGPL-3.0-or-later
// Joins two takes of one rig: the second fades in over the last frames of the first.
#pragma once

#include <vector>

#include "core/motion/plants.h"

namespace limber {

struct JoinSettings {
  int fade = 1;             // frames in which both takes play, at least 1
  bool keeps_feet = false;  // feet that stand in the cross-fade stay in place
  double ease = 0.15;       // s: over which a foot comes to its place and leaves it
};

struct JoinedPoses {
  std::vector<Pose> poses;    // as many as both takes have, less those of the cross-fade
  int fade_first = 0;         // the frame at which the cross-fade begins, and with it the second take
  std::vector<Plant> plants;  // the feet that are kept in place
  // The farthest that a foot has to go from where it stands in the first take to where it stands in the second without
  // being lifted, mm: it slides there.
  double foot_gap = 0;
};

// Returns the takes joined. The second one is moved along the ground and turned about the vertical, so that its first
// frame has the place and heading of the first take's frame at which the cross-fade begins. With keeps_feet, a foot
// that stands in both takes at the middle of the cross-fade, at places less than a seventh of its leg apart, stays
// where the first take has it as long as the second one lets it stand, and the second take is moved to it.
//   rate  frames per second, of both takes
// Throws Error for a cross-fade that is longer than a take, a rig with several root bones, and as planted() does.
JoinedPoses joined(const Armature& armature, const std::vector<PlantedLimb>& limbs, const std::vector<Pose>& first,
                   const std::vector<Pose>& second, double rate, const JoinSettings& settings);

}  // namespace limber
