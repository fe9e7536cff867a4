// SPDX-License-Identifier: AGPL-3.0-or-later
// A rig of legs and arms, and a motion in which the feet slide over the ground while they should stand still.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/rig/pose.h"
#include "tests/support/random_limbs.h"

namespace limber::test {

// Returns a rig of legs and arms only. The body looks along -y.
inline Armature walker() {
  Armature rig;
  const auto add = [&](const char* name, int parent, const glm::dvec3& head, const glm::dvec3& tail) {
    rig.bones.push_back({name, parent, head, tail, 0, {}});
    return static_cast<int>(rig.bones.size()) - 1;
  };
  const int hips = add("Hips", -1, {0, 0, 900}, {0, 0, 1000});
  for (const int side : {1, -1}) {
    const std::string which = side > 0 ? "Left" : "Right";
    const double x = 100.0 * side;
    const int thigh = add((which + "UpLeg").c_str(), hips, {x, 0, 900}, {x, -10, 480});
    const int shank = add((which + "Leg").c_str(), thigh, {x, -10, 480}, {x, 0, 80});
    add((which + "Foot").c_str(), shank, {x, 0, 80}, {x, -150, 10});
  }
  const int chest = add("Spine", hips, {0, 0, 1000}, {0, 0, 1450});
  for (const int side : {1, -1}) {
    const std::string which = side > 0 ? "Left" : "Right";
    const double x = 200.0 * side;
    const int upper = add((which + "Arm").c_str(), chest, {x, 0, 1400}, {x, 10, 1100});
    const int lower = add((which + "ForeArm").c_str(), upper, {x, 10, 1100}, {x, 0, 850});
    add((which + "Hand").c_str(), lower, {x, 0, 850}, {x, 0, 760});
  }
  return rig;
}

// Returns poses of stepping in place with a forward drift, as in a bad recording: standing feet slide along with the
// body.
inline std::vector<Pose> sliding_steps(const Armature& rig, int frames, double tremble = 0) {
  RandomNumbers random(7);
  std::vector<Pose> poses;
  for (int f = 0; f < frames; ++f) {
    Pose pose = rest_pose(rig);
    pose.root_translation = {0, -2.0 * f, 3 * std::sin(f * 0.2)};
    for (const int side : {0, 1}) {
      const double lift = std::max(0.0, std::sin(f * 0.15 + side * std::numbers::pi));
      const int thigh = 1 + 3 * side;
      pose.rotation[thigh] = glm::angleAxis(-0.9 * lift, glm::dvec3(1, 0, 0));
      pose.rotation[thigh + 1] = glm::angleAxis(1.2 * lift, glm::dvec3(1, 0, 0));
    }
    for (auto& turn : pose.rotation)
      turn = glm::normalize(turn * glm::angleAxis(tremble * random.any(-1, 1), glm::dvec3(0, 1, 0)));
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace limber::test
