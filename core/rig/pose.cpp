// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/pose.h"

#include <numbers>

namespace limber {

Pose rest_pose(const Armature& armature) {
  return {std::vector<glm::dquat>(armature.bones.size(), glm::dquat(1, 0, 0, 0)), glm::dvec3(0)};
}

std::vector<RigidTransform> posed_from_rest(const Armature& armature, const Pose& pose) {
  std::vector<RigidTransform> posed(armature.bones.size());
  for (size_t i = 0; i < posed.size(); ++i) {
    const Bone& bone = armature.bones[i];
    RigidTransform own = rotation_about(bone.head, pose.rotation[i]);
    if (!pose.shift.empty()) own.translation += pose.shift[i];
    const bool still = own.rotation == glm::dquat(1, 0, 0, 0) && own.translation == glm::dvec3(0);
    if (bone.parent < 0) posed[i] = {own.rotation, own.translation + pose.root_translation};
    else posed[i] = still ? posed[bone.parent] : posed[bone.parent] * own;
  }
  return posed;
}

void flex(Pose& pose, const Armature& armature, int bone, double degrees) {
  const glm::dquat turn = glm::angleAxis(degrees * std::numbers::pi / 180, flex_axis(armature, bone));
  pose.rotation[bone] = glm::normalize(turn * pose.rotation[bone]);
}

}  // namespace limber
