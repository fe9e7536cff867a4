// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/join_poses.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/motion/ground_move.h"

namespace limber {

namespace {

// A foot that stands in both takes at positions nearer than this share of its leg's length gets one position.
constexpr double kNear = 1.0 / 7;

Pose mixed(const Pose& a, const Pose& b, double share) {
  Pose pose = a;
  for (std::size_t bone = 0; bone < pose.rotation.size(); ++bone)
    pose.rotation[bone] = glm::normalize(glm::slerp(a.rotation[bone], b.rotation[bone], share));
  pose.root_translation = glm::mix(a.root_translation, b.root_translation, share);
  return pose;
}

double leg_length(const Armature& armature, const PlantedLimb& limb) {
  const Bone &upper = armature.bones[limb.upper], &lower = armature.bones[limb.lower];
  return glm::distance(upper.head, lower.head) + glm::distance(lower.head, lower.tail);
}

bool same_point(const Plant& a, const Plant& b) { return a.limb == b.limb && a.point == b.point; }
double apart(const Plant& a, const Plant& b) { return std::hypot(a.place.x - b.place.x, a.place.y - b.place.y); }

// The frames in which feet stand in the joined takes. They are found in each take alone: in the cross-fade a foot
// slides, so its stance could not be found there.
class Stances {
 public:
  // Finds the stances that overlap the cross-fade.
  //   first, second  plants of the feet of each take, in frames of that take
  //   fade_first     frame of the first take at which the cross-fade begins
  //   middle         last frame of the cross-fade in which the first take's plants are used
  //   ease           frames over which a foot moves to its position and away from it
  Stances(const Armature& armature, const std::vector<PlantedLimb>& limbs, const std::vector<Plant>& first,
          std::vector<Plant> second, int fade_first, int middle, int ease) {
    for (Plant& plant : second) plant.first += fade_first, plant.last += fade_first;
    for (const Plant& plant : first)
      if (plant.last >= fade_first && plant.first <= middle) before_.push_back(plant);
    for (const Plant& plant : second)
      if (plant.last > middle) after_.push_back(plant);
    for (const Plant& b : after_) {
      const bool is_first = std::none_of(after_.begin(), after_.end(), [&](const Plant& other) {
        return same_point(other, b) && other.first < b.first;
      });
      if (!is_first || b.first > middle + 1 + ease) continue;
      const Plant* a = nullptr;  // the latest plant of the first take that is of the same foot and point as `b`
      for (const Plant& plant : before_)
        if (same_point(plant, b) && (!a || plant.last > a->last)) a = &plant;
      if (!a || a->last < middle - ease) continue;
      if (apart(*a, b) < kNear * leg_length(armature, limbs[b.limb])) pairs_.push_back({*a, b});
      else gap_ = std::max(gap_, apart(*a, b));
    }
  }

  // Returns the mean horizontal vector from the feet of the second take to the same feet of the first take, mm.
  glm::dvec3 shift() const {
    glm::dvec3 sum(0);
    for (const auto& [a, b] : pairs_) sum += a.place - b.place;
    return pairs_.empty() ? sum : glm::dvec3(sum.x, sum.y, 0) / double(pairs_.size());
  }

  // Returns the plants that overlap the cross-fade, after the second take was moved by shift().
  std::vector<Plant> plants(int middle, int fade_last) const {
    std::vector<Plant> all;
    const auto is_paired = [&](const Plant& plant, bool second) {
      return std::any_of(pairs_.begin(), pairs_.end(), [&](const Pair& pair) {
        const Plant& one = second ? pair.b : pair.a;
        return same_point(one, plant) && one.first == plant.first;
      });
    };
    for (const Pair& pair : pairs_) {
      Plant whole = pair.a;
      whole.last = pair.b.last;
      all.push_back(whole);
    }
    for (Plant plant : before_) {
      if (is_paired(plant, false)) continue;
      plant.last = std::min(plant.last, middle);
      all.push_back(plant);
    }
    for (Plant plant : after_) {
      if (is_paired(plant, true) || plant.first > fade_last) continue;
      plant.first = std::max(plant.first, middle + 1);
      plant.place += shift();
      all.push_back(plant);
    }
    return all;
  }
  double gap() const { return gap_; }

 private:
  struct Pair {
    Plant a, b;
  };
  std::vector<Plant> before_, after_;  // plants of the first take, and of the second take
  std::vector<Pair> pairs_;
  double gap_ = 0;
};

}  // namespace

JoinedPoses joined(const Armature& armature, const std::vector<PlantedLimb>& limbs, const std::vector<Pose>& first,
                   const std::vector<Pose>& second, double rate, const JoinSettings& settings) {
  const std::size_t most = std::min(first.size(), second.size());
  if (settings.fade < 1 || static_cast<std::size_t>(settings.fade) > most)
    throw Error("the cross-fade is longer than a motion", std::to_string(settings.fade) + " frames",
                "use a length from 1 to " + std::to_string(most));
  JoinedPoses out;
  out.fade_first = static_cast<int>(first.size()) - settings.fade;
  const int fade_last = static_cast<int>(first.size()) - 1, middle = out.fade_first + (settings.fade - 1) / 2;
  std::vector<Pose> next;
  const GroundMove move = move_to(armature, second.front(), first[out.fade_first]);
  for (const Pose& pose : second) next.push_back(moved(armature, pose, move));

  const int ease = static_cast<int>(std::lround(std::min(settings.ease * rate, 1e6)));
  if (settings.keeps_feet) {
    const Stances stances(armature, limbs, plants_of_feet(armature, limbs, first, rate),
                          plants_of_feet(armature, limbs, next, rate), out.fade_first, middle, ease);
    for (Pose& pose : next) pose.root_translation += stances.shift();
    out.plants = stances.plants(middle, fade_last);
    out.foot_gap = stances.gap();
  }
  out.poses.assign(first.begin(), first.begin() + out.fade_first);
  for (int f = 0; f < settings.fade; ++f) {
    const double share = (f + 1.0) / (settings.fade + 1.0);
    out.poses.push_back(mixed(first[out.fade_first + f], next[f], share * share * (3 - 2 * share)));
  }
  out.poses.insert(out.poses.end(), next.begin() + settings.fade, next.end());
  if (!out.plants.empty()) out.poses = planted(armature, limbs, out.poses, out.plants, ease);
  return out;
}

}  // namespace limber
