// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/limit_check.h"

#include "core/rig/joint_limits.h"

namespace limber {

LimitCheck check_limits(const Armature& armature, const Pose& pose, double tolerance) {
  LimitCheck check;
  for (std::size_t b = 0; b < armature.bones.size() && b < pose.rotation.size(); ++b) {
    const Bone& bone = armature.bones[b];
    if (bone.limits.type == JointLimits::Type::Free) {
      check.unlimited += bone.parent >= 0;
      continue;
    }
    ++check.limited;
    const double excess = limit_excess(bone, pose.rotation[b]);
    if (excess <= tolerance) continue;
    if (++check.beyond == 1) check.first = static_cast<int>(b);
    if (excess > check.excess) check.excess = excess, check.worst = static_cast<int>(b);
  }
  return check;
}

std::string words_of(const LimitCheck& check, const Armature& armature) {
  if (check.limited == 0) return "the rig has none";
  if (check.beyond == 1) return armature.bones[check.first].name + " is beyond";
  if (check.beyond > 1)
    return armature.bones[check.first].name + " and " + std::to_string(check.beyond - 1) + " more are beyond";
  if (check.unlimited == 0) return "all within";
  return std::to_string(check.limited) + " within, " + std::to_string(check.unlimited) + " without limits";
}

}  // namespace limber
