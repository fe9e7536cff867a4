// SPDX-License-Identifier: AGPL-3.0-or-later
// Limit rotation: the rotation vector of a bone, relative to its parent, stays within a range about each of the bone's
// own axes at rest. Unlike Euler angles, the components of the vector do not depend on an order of axes, and they
// change smoothly up to half a turn.
#include "core/motion/constraint_rule.h"
#include "core/motion/key_curve.h"
#include "core/rig/joint_limits.h"

namespace limber {

namespace {

void solve(const ConstraintOnRig& on_rig, PosedRig& rig) {
  const Constraint& constraint = on_rig.constraint;
  const glm::dmat3 axes = rest_axes(rig.armature().bones[on_rig.bone]);
  const glm::dvec3 turn = glm::transpose(axes) * turn_between(glm::dquat(1, 0, 0, 0), rig.pose().rotation[on_rig.bone]);
  glm::dvec3 within = turn;
  for (int axis = 0; axis < 3; ++axis)
    if (constraint.axes[axis])
      within[axis] = std::min(std::max(turn[axis], constraint.minimum[axis]), constraint.maximum[axis]);
  if (within != turn) rig.set(on_rig.bone, exponential(axes * within));
}

}  // namespace

ConstraintRule limit_rotation_constraint() {
  return {ConstraintKind::LimitRotation,
          "limit_rotation",
          "Limit rotation",
          "Keep the bone's rotation about each of its local axes within a range.",
          ConstraintTarget::None,
          turned_alone,
          solve};
}

}  // namespace limber
