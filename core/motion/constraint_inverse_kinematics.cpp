// SPDX-License-Identifier: AGPL-3.0-or-later
// Inverse kinematics: a chain of bones turns so that the tail of its last bone comes to the target, or as near to the
// target as it can (core/rig/inverse_kinematics.h). The search starts from the pose of motion and keys, so that the
// result changes smoothly from frame to frame.
#include "core/base/error.h"
#include "core/motion/constraint_rule.h"
#include "core/rig/inverse_kinematics.h"

namespace limber {

namespace {

// Number of further start poses of the search. More start poses could find other bends of the limb, which would jump
// between frames. These two are close to the given pose; a straight chain needs them to bend at all.
constexpr int kRestarts = 2;

std::vector<int> turned(const ConstraintOnRig& on_rig, const Armature& armature) {
  std::vector<int> bones;
  for (int bone = on_rig.bone; bone >= 0; bone = armature.bones[bone].parent) {
    bones.push_back(bone);
    if (std::ssize(bones) == on_rig.constraint.chain) break;
  }
  return bones;
}

void solve(const ConstraintOnRig& on_rig, PosedRig& rig) {
  const Reach found =
      reach(rig.armature(), rig.pose(),
            {{.bone = on_rig.bone, .target = target_place(on_rig, rig), .chain = on_rig.constraint.chain}},
            {.keep_limits = on_rig.constraint.keep_limits, .restarts = kRestarts});
  Pose next = rig.pose();
  for (const int bone : turned(on_rig, rig.armature())) next.rotation[bone] = found.pose.rotation[bone];
  rig.set_all(next);
}

}  // namespace

ConstraintRule inverse_kinematics_constraint() {
  return {ConstraintKind::InverseKinematics,
          "inverse_kinematics",
          "Inverse kinematics",
          "Turn a chain of bones so that the bone's tail reaches its target.",
          ConstraintTarget::Place,
          turned,
          solve};
}

}  // namespace limber
