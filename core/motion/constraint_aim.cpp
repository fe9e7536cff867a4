// SPDX-License-Identifier: AGPL-3.0-or-later
// Aim: one of the bone's own axes points from the bone's head at the target. The bone takes the shortest rotation to
// this direction, so that it does not roll.
#include "core/motion/body_frame.h"
#include "core/motion/constraint_rule.h"

namespace limber {

namespace {

// Distance from the bone's head, mm, below which a target gives no direction, so that the bone does not turn.
constexpr double kNearest = 1e-6;

void solve(const ConstraintOnRig& on_rig, PosedRig& rig) {
  const glm::dvec3 towards = target_place(on_rig, rig) - rig.head(on_rig.bone);
  if (glm::length(towards) < kNearest) return;
  const int aim = static_cast<int>(on_rig.constraint.aim);
  const glm::dvec3 axis = rest_axes(rig.armature().bones[on_rig.bone])[aim / 2];
  rig.turn_by(on_rig.bone, shortest_turn(rig.turn(on_rig.bone) * (aim % 2 == 0 ? axis : -axis), towards));
}

}  // namespace

ConstraintRule aim_constraint() {
  return {ConstraintKind::Aim,     "aim",        "Aim", "Turn the bone so that it points at its target.",
          ConstraintTarget::Place, turned_alone, solve};
}

}  // namespace limber
