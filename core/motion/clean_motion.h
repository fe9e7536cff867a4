// SPDX-License-Identifier: AGPL-3.0-or-later
// Cleans a recorded motion of a rig: feet that stand no longer slide, and hands are held at given positions.
#pragma once

#include <vector>

#include "core/motion/plants.h"

namespace limber {

struct CleanedMotion {
  std::vector<Pose> poses;
  std::vector<Plant> plants;  // plants of the feet that were found to stand, followed by the given holds
};

// Returns the poses in which each limb that has a hold stays at the hold's position. With `plants_feet`, each foot also
// stays in place while it stands, unless a hold moves this foot.
//   limbs  from planted_limbs()
//   rate   frames per second
//   ease   seconds over which a limb moves to its position before the hold, and back after it
// Throws Error as planted() does.
CleanedMotion clean_motion(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                           const std::vector<Pose>& poses, double rate, bool plants_feet,
                           const std::vector<Plant>& holds, double ease, Progress& progress = no_progress());

}  // namespace limber
