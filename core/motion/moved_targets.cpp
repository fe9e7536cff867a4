// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/moved_targets.h"

#include "core/motion/constraint_rule.h"

namespace limber {

namespace {

constexpr double kUnmoved = 1e-6;  // mm; smaller differences are the rounding of a rig's file, not a move

bool is_moved(const Bone& before, const Bone& after) {
  return glm::distance(before.head, after.head) > kUnmoved || glm::distance(before.tail, after.tail) > kUnmoved;
}

}  // namespace

std::vector<std::string> moved_targets(const Constraints& constraints, const Armature& before, const Armature& after,
                                       const std::vector<int>& from) {
  std::vector<std::string> moved;
  for (const Constraint& constraint : constraints.list) {
    // Only constraints with a target position are affected. Copied rotations do not depend on where the target bone is.
    if (constraint_rule(constraint.kind).target != ConstraintTarget::Place) continue;
    const auto target = after.find(constraint.target);
    // The target is a position in the world, or its bone no longer exists. In the second case the constraint's
    // problem() says so.
    if (!target) continue;
    const int old = from[static_cast<std::size_t>(*target)];
    if (old < 0 || is_moved(before.bones[old], after.bones[*target])) moved.push_back(constraint.name);
  }
  return moved;
}

}  // namespace limber
