// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/ground_move.h"

#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace limber {

int only_root(const Armature& armature) {
  int root = -1, roots = 0;
  for (int bone = 0; bone < std::ssize(armature.bones); ++bone)
    if (armature.bones[bone].parent < 0) root = bone, ++roots;
  if (roots != 1)
    throw Error("the body cannot be turned as a whole", "the rig has " + std::to_string(roots) + " root bones",
                "use a rig with one root bone");
  return root;
}

glm::dvec3 root_place(const Armature& armature, const Pose& pose) {
  return armature.bones[only_root(armature)].head + pose.root_translation;
}

GroundMove move_to(const Armature& armature, const Pose& pose, const Pose& wanted) {
  const int root = only_root(armature);
  const glm::dquat between = wanted.rotation[root] * glm::conjugate(pose.rotation[root]);
  GroundMove move;
  if (std::hypot(between.z, between.w) > 1e-9)
    move.turn = std::remainder(2 * std::atan2(between.z, between.w), 2 * std::numbers::pi);
  move.from = root_place(armature, pose);
  move.to = root_place(armature, wanted);
  move.to.z = move.from.z;
  return move;
}

Pose moved(const Armature& armature, Pose pose, const GroundMove& move) {
  const int root = only_root(armature);
  const glm::dvec3 head = armature.bones[root].head;
  pose.root_translation = move.place(head + pose.root_translation) - head;
  pose.rotation[root] = glm::normalize(move.rotation() * pose.rotation[root]);
  return pose;
}

}  // namespace limber
