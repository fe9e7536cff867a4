// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/clean_motion.h"

#include <algorithm>
#include <cmath>

namespace limber {

CleanedMotion clean_motion(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                           const std::vector<Pose>& poses, double rate, bool plants_feet,
                           const std::vector<Plant>& holds, double ease, Progress& progress) {
  const int frames = static_cast<int>(std::lround(std::min(ease * rate, double(poses.size()))));
  CleanedMotion cleaned;
  if (plants_feet) cleaned.plants = plants_of_feet(armature, limbs, poses, rate, progress);
  for (const Plant& hold : holds) cleaned.plants = without_held(cleaned.plants, hold, frames);
  cleaned.plants.insert(cleaned.plants.end(), holds.begin(), holds.end());
  cleaned.poses = planted(armature, limbs, poses, cleaned.plants, frames, progress);
  return cleaned;
}

}  // namespace limber
