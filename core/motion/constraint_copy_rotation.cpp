// SPDX-License-Identifier: AGPL-3.0-or-later
// Copy rotation: a bone rotates from its rest pose as another bone does. If all axes are selected, the copy is exact.
// Otherwise the rotation from the bone's own orientation to the other bone's is written as a rotation vector along the
// bone's own axes, and only the selected components are applied. A head can so copy the nodding of its target without
// copying how the body faces.
#include "core/motion/constraint_rule.h"
#include "core/motion/key_curve.h"
#include "core/rig/joint_limits.h"

namespace limber {

namespace {

void solve(const ConstraintOnRig& on_rig, PosedRig& rig) {
  const Constraint& constraint = on_rig.constraint;
  const bool in_world = constraint.space == RotationSpace::World;
  const auto rotation = [&](int bone) { return in_world ? rig.turn(bone) : rig.pose().rotation[bone]; };
  glm::dquat copied = rotation(on_rig.target);
  if (constraint.axes != std::array<bool, 3>{true, true, true}) {
    const glm::dmat3 axes = rest_axes(rig.armature().bones[on_rig.bone]), back = glm::transpose(axes);
    const glm::dquat own = rotation(on_rig.bone);
    glm::dvec3 parts = back * turn_between(glm::dquat(1, 0, 0, 0), glm::conjugate(own) * copied);
    for (int axis = 0; axis < 3; ++axis)
      if (!constraint.axes[axis]) parts[axis] = 0;
    copied = glm::normalize(own * exponential(axes * parts));
  }
  if (in_world) rig.turn_to(on_rig.bone, copied);
  else rig.set(on_rig.bone, copied);
}

}  // namespace

ConstraintRule copy_rotation_constraint() {
  return {ConstraintKind::CopyRotation,
          "copy_rotation",
          "Copy rotation",
          "Copy the rotation of the target bone, measured from rest, to the bone.",
          ConstraintTarget::Bone,
          turned_alone,
          solve};
}

}  // namespace limber
