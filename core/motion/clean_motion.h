// SPDX-License-Identifier: AGPL-3.0-or-later
// Cleans a recorded motion of a rig: feet that stand no longer slide, and hands are held at given positions.
#pragma once

#include <vector>

#include "core/motion/plants.h"

namespace limber {

struct CleanedMotion {
  std::vector<Pose> poses;
  std::vector<Plant> plants;  // the feet that were found to stand, then the holds
};

// Returns the poses in which each hold keeps its limb at its position and, if wanted, each foot stays in place while it
// stands. A foot that a hold keeps is not planted as well.
//   limbs  from planted_limbs()
//   rate   frames per second
//   ease   seconds over which a limb moves to its position before the hold, and back after it
// Throws Error as planted() does.
CleanedMotion clean_motion(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                           const std::vector<Pose>& poses, double rate, bool plants_feet,
                           const std::vector<Plant>& holds, double ease, Progress& progress = no_progress());

}  // namespace limber
