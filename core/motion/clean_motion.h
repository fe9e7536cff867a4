// SPDX-License-Identifier: AGPL-3.0-or-later
// Cleans a recorded motion of a rig: feet that stand stay in place, and hands are held where they should be.
#pragma once

#include <vector>

#include "core/motion/plants.h"

namespace limber {

struct CleanedMotion {
  std::vector<Pose> poses;
  std::vector<Plant> plants;  // the feet that were found to stand, then the holds
};

// Returns the poses with the limb of each hold at its place and, if wanted, each foot in place while it stands. What is
// held is not planted as well.
//   limbs  from planted_limbs()
//   rate   frames per second
//   ease   seconds over which a limb comes to its place and leaves it
// Throws Error as planted() does.
CleanedMotion clean_motion(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                           const std::vector<Pose>& poses, double rate, bool plants_feet,
                           const std::vector<Plant>& holds, double ease, Progress& progress = no_progress());

}  // namespace limber
