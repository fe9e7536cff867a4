// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/pose_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limber {

Pose part_of_pose(const Pose& pose, double t) {
  if (t == 1) return pose;
  Pose part = pose;
  for (glm::dquat& turn : part.rotation)
    turn =
        t == 0 || turn == glm::dquat(1, 0, 0, 0) ? glm::dquat(1, 0, 0, 0) : glm::slerp(glm::dquat(1, 0, 0, 0), turn, t);
  part.root_translation *= t;
  for (glm::dvec3& shift : part.shift) shift *= t;
  return part;
}

Pose pose_between(const Pose& from, const Pose& to, double t) {
  if (t == 0) return from;
  if (t == 1) return to;
  Pose between = to;
  for (size_t b = 0; b < to.rotation.size(); ++b)
    if (from.rotation[b] != to.rotation[b]) between.rotation[b] = glm::slerp(from.rotation[b], to.rotation[b], t);
  between.root_translation = from.root_translation + t * (to.root_translation - from.root_translation);
  if (from.shift.empty() && to.shift.empty()) return between;
  between.shift.resize(to.rotation.size(), glm::dvec3(0));
  const auto shift_of = [](const Pose& pose, size_t b) { return pose.shift.empty() ? glm::dvec3(0) : pose.shift[b]; };
  for (size_t b = 0; b < to.rotation.size(); ++b) between.shift[b] = glm::mix(shift_of(from, b), shift_of(to, b), t);
  return between;
}

std::vector<RigidTransform> bone_motions(const std::vector<std::string>& bones, const Armature& armature,
                                         const Pose& pose) {
  const std::vector<RigidTransform> posed = posed_from_rest(armature, pose);
  std::vector<RigidTransform> motions;
  for (const std::string& name : bones) motions.push_back(posed[require_bone(armature, name)]);
  return motions;
}

double largest_angle_degrees(const Pose& pose) {
  double largest = 0;
  for (const glm::dquat& turn : pose.rotation)
    largest = std::max(largest, 2 * std::atan2(glm::length(glm::dvec3(turn.x, turn.y, turn.z)), std::abs(turn.w)));
  return largest * 180 / std::numbers::pi;
}

double largest_angle_degrees(const Pose& from, const Pose& to) {
  Pose turn = to;
  for (size_t b = 0; b < turn.rotation.size(); ++b)
    turn.rotation[b] = to.rotation[b] * glm::conjugate(from.rotation[b]);
  return largest_angle_degrees(turn);
}

}  // namespace limber
