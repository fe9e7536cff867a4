// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/apply_pose_as_rest.h"

#include <algorithm>

#include "core/rig/joint_limits.h"

namespace limber {

Armature with_pose_as_rest(const Armature& armature, const Pose& pose) {
  const auto posed = posed_from_rest(armature, pose);
  Armature next = armature;
  for (std::size_t b = 0; b < next.bones.size(); ++b) {
    const Bone& before = armature.bones[b];
    Bone& bone = next.bones[b];
    bone.head = posed[b] * before.head;
    bone.tail = posed[b] * before.tail;
    bone.roll = roll_of(bone, posed[b].rotation * rest_axes(before)[0]);
    JointLimits& limits = bone.limits;
    if (limits.axis == glm::dvec3(0)) continue;
    // Rotates the axis of the joint limits: the axis of a hinge rotates with the parent bone, the axis of a ball joint
    // with the bone itself.
    const bool hinge = limits.type == JointLimits::Type::Hinge;
    const glm::dquat carries = !hinge              ? posed[b].rotation
                               : before.parent < 0 ? glm::dquat(1, 0, 0, 0)
                                                   : posed[static_cast<std::size_t>(before.parent)].rotation;
    limits.axis = glm::normalize(carries * before.limits.axis);
    if (!hinge) continue;
    const double angle = swing_twist(pose.rotation[b], before.limits.axis).twist;
    limits.minimum = std::min(0.0, limits.minimum - angle);
    limits.maximum = std::max(0.0, limits.maximum - angle);
  }
  return next;
}

}  // namespace limber
