// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/reduce_planted.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/motion/key_curve.h"

namespace limber {

namespace {

constexpr int kMostRounds = 12;  // after so many rounds the keys are returned even if a plant is still not kept
// The allowed error of a bone, degrees, is not lowered below this value, which moves a foot by microns.
constexpr double kSmallestAngle = 1e-4;
constexpr double kSmallestShift = 1e-3;  // mm; the allowed error of the body's shift is not lowered further

// Returns the poses that the keys give at the frames `start` to `start` + `count` - 1.
std::vector<Pose> poses_of_keys(const Armature& armature, const Keys& keys, int start, std::size_t count,
                                Progress& progress) {
  std::vector<Pose> poses(count, rest_pose(armature));
  for (std::size_t f = 0; f < count; ++f) {
    if (progress.cancelled()) throw Cancelled();
    const double frame = start + static_cast<double>(f);
    for (std::size_t bone = 0; bone < armature.bones.size(); ++bone)
      if (const auto found = keys.bones.find(armature.bones[bone].name); found != keys.bones.end())
        poses[f].rotation[bone] = value_at(found->second, shapes_of(keys, armature.bones[bone].name), frame);
    if (!keys.root.empty()) poses[f].root_translation = value_at(keys.root, keys.root_shapes, frame);
  }
  return poses;
}

int carrier_of(const PlantedLimb& limb) { return limb.end >= 0 ? limb.end : limb.lower; }

// Returns the largest distance, in a plant's frames, of its point from the recorded position, mm.
double most_off_in(const Plant& plant, const LimbTracks& recorded, const LimbTracks& played) {
  const auto point = static_cast<std::size_t>(plant.point);
  double most = 0;
  for (int f = plant.first; f <= plant.last; ++f)
    most = std::max(most, glm::distance(recorded[plant.limb][point][f], played[plant.limb][point][f]));
  return most;
}

// Lowers, in the frames of a plant, the allowed errors of the body's shift and of the bones from the root to the
// planted point. If the errors have random directions, together they then move the point by about `mm`.
void tighten(AllowedErrors& allowed, const Plant& plant, const Armature& armature,
             const std::vector<PlantedLimb>& limbs, const Pose& pose, double mm) {
  const glm::dvec3 point = place_of(limbs[plant.limb], plant.point, armature, pose);
  const std::vector<RigidTransform> posed = posed_from_rest(armature, pose);
  // Bones from the limb up to the root, with their distances from the point (lever arms), mm.
  std::vector<std::pair<int, double>> carriers;
  for (int bone = carrier_of(limbs[plant.limb]); bone >= 0; bone = armature.bones[bone].parent) {
    const double arm = glm::distance(posed[bone] * armature.bones[bone].head, point);
    if (arm > 1e-6) carriers.emplace_back(bone, arm);
  }
  const double share = mm / std::sqrt(static_cast<double>(carriers.size() + 1));
  for (int f = plant.first; f <= plant.last; ++f) {
    for (const auto& [bone, arm] : carriers)
      allowed.degrees[bone][f] =
          std::min(allowed.degrees[bone][f], std::max(kSmallestAngle, glm::degrees(share / arm)));
    allowed.mm[f] = std::min(allowed.mm[f], std::max(kSmallestShift, share));
  }
}

}  // namespace

std::vector<Plant> resting_limbs(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                                 const std::vector<Pose>& poses, double rate, Progress& progress) {
  std::vector<Plant> plants = plants_of_feet(armature, limbs, poses, rate, progress);
  for (const Plant& plant : plants_at_rest(armature, limbs, poses, rate, progress))
    if (!limbs[plant.limb].is_leg) plants.push_back(plant);
  return plants;
}

PlantedKeys reduced_with_plants(const Armature& armature, const std::vector<PlantedLimb>& limbs,
                                const std::vector<Pose>& poses, int start, const ReduceSettings& settings,
                                const std::vector<Plant>& plants, double plant_mm, Progress& progress) {
  if (!(plant_mm > 0)) throw Error("the allowed error must be positive", "planted feet", "enter an error above 0");
  AllowedErrors allowed = allowed_everywhere(armature, poses.size(), settings);
  std::vector<double> aims(plants.size(), plant_mm);
  const LimbTracks recorded = limb_tracks(armature, limbs, poses, progress);
  KeyFitter fitter(armature, poses, start);
  PlantedKeys result;
  for (int round = 0;; ++round) {
    result.reduced = fitter.fitted(allowed, progress);
    const LimbTracks played = limb_tracks(
        armature, limbs, poses_of_keys(armature, result.reduced.keys, start, poses.size(), progress), progress);
    result.most_off = 0;
    bool any = false;
    for (std::size_t i = 0; i < plants.size(); ++i) {
      const double off = most_off_in(plants[i], recorded, played);
      result.most_off = std::max(result.most_off, off);
      if (off <= plant_mm) continue;
      any = true;
      if (round > 0) aims[i] *= std::min(0.67, 0.9 * plant_mm / off);
      tighten(allowed, plants[i], armature, limbs, poses[plants[i].first], aims[i]);
    }
    if (!any || round == kMostRounds) return result;
  }
}

}  // namespace limber
