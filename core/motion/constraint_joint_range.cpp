// SPDX-License-Identifier: AGPL-3.0-or-later
// Joint range: the bone stays within the joint limits that the rig stores (core/rig/joint_limits.h).
#include "core/motion/constraint_rule.h"
#include "core/rig/joint_limits.h"

namespace limber {

namespace {

void solve(const ConstraintOnRig& on_rig, PosedRig& rig) {
  const glm::dquat rotation = rig.pose().rotation[on_rig.bone],
                   allowed = within_limits(rig.armature().bones[on_rig.bone], rotation);
  if (allowed != rotation) rig.set(on_rig.bone, allowed);
}

}  // namespace

ConstraintRule joint_range_constraint() {
  return {ConstraintKind::JointRange, "joint_range", "Joint range", "Keep the bone within the limits of its joint.",
          ConstraintTarget::None,     turned_alone,  solve};
}

}  // namespace limber
