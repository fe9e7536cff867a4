// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes few keys of many frames, and keeps planted feet and hands in place. Small errors of the bones from the pelvis
// to a foot add up to a centimetre at the foot, so feet that stood would slide again. In the frames in which a foot
// stands or a hand is held, the bones above it therefore get smaller allowed errors, until the foot or hand stays
// within a given distance of its recorded position. In all other frames the allowed errors of reduce_keys.h apply.
#pragma once

#include "core/motion/plants.h"
#include "core/motion/reduce_keys.h"

namespace limber {

// Finds the feet that stand (plants_of_feet()), and the hands that rest at one position (plants_at_rest()).
std::vector<Plant> resting_limbs(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                                 const std::vector<Pose>& poses, double rate, Progress& progress = no_progress());

struct PlantedKeys {
  ReducedKeys reduced;
  // largest distance of a planted point from its recorded position, in the frames of its plant, mm
  double most_off = 0;
};

// Returns keys as reduced_to_keys() does. They also keep the points of the plants within `plant_mm` of their positions
// in the poses.
//   limbs   from planted_limbs()
//   plants  with frames counted from the first pose
PlantedKeys reduced_with_plants(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                                const std::vector<Pose>& poses, int start, const ReduceSettings& settings,
                                const std::vector<Plant>& plants, double plant_mm, Progress& progress);

}  // namespace limber
