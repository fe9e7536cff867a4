// SPDX-License-Identifier: AGPL-3.0-or-later
// Plant: a hand or foot keeps its position in the world or on another bone, and if wanted its orientation. The two long
// bones of the limb turn to make this possible, by the law of cosines: the elbow or knee bends in the plane in which it
// is already bent. If the limb is too short or too long to reach the position, its end comes as near to the position as
// possible.
#include <algorithm>
#include <cmath>

#include "core/motion/body_frame.h"
#include "core/motion/constraint_rule.h"
#include "core/motion/limb_bend.h"

namespace limber {

namespace {

glm::dvec3 joint_of(const ConstraintOnRig& on_rig, const PosedRig& rig) {
  return has_planted_end(on_rig) ? rig.head(on_rig.bone) : rig.tail(on_rig.bone);
}

// Returns the axis about which the limb bends, perpendicular to the upper bone. It is the axis about which the limb is
// already bent, with the sign of the hinge. If the limb is nearly straight, or is bent the wrong way, its plane is
// arbitrary, and the hinge gives the axis.
//   upper, lower  vectors from joint to joint, mm
glm::dvec3 bending_axis(const glm::dvec3& upper, const glm::dvec3& lower, const glm::dvec3& hinge) {
  constexpr double kOfHinge = 0.1;
  const glm::dvec3 along = glm::normalize(upper), bent = glm::cross(along, glm::normalize(lower));
  const glm::dvec3 axis = bent + (kOfHinge + std::max(0.0, -2 * glm::dot(bent, hinge))) * hinge;
  for (const glm::dvec3& wanted : {axis, glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0)}) {
    const glm::dvec3 across = wanted - glm::dot(wanted, along) * along;
    if (glm::length(across) > 1e-9) return glm::normalize(across);
  }
  return {1, 0, 0};
}

void bring_joint(const ConstraintOnRig& on_rig, PosedRig& rig, const glm::dvec3& target) {
  const glm::dvec3 root = rig.head(on_rig.upper), middle = rig.head(on_rig.lower);
  const glm::dvec3 upper = middle - root, lower = joint_of(on_rig, rig) - middle;
  const double a = glm::length(upper), b = glm::length(lower);
  if (a == 0 || b == 0) return;
  const glm::dvec3 axis = bending_axis(upper, lower, rig.turn(on_rig.upper) * on_rig.hinge);
  // First turns the lower bone into the plane perpendicular to the axis: only there can bending reach every distance
  // between a straight and a folded limb.
  const glm::dvec3 flat = lower - glm::dot(lower, axis) * axis;
  rig.turn_by(on_rig.lower, shortest_turn(lower, flat));
  const double wanted = std::clamp(glm::distance(root, target), std::abs(a - b), a + b);
  const glm::dvec3 turned = joint_of(on_rig, rig) - middle;
  rig.turn_by(on_rig.lower, glm::angleAxis(bend_for(upper, turned, axis, wanted), axis));
  rig.turn_by(on_rig.upper, shortest_turn(joint_of(on_rig, rig) - root, target - root));
}

std::vector<int> turned(const ConstraintOnRig& on_rig, const Armature&) {
  if (has_planted_end(on_rig)) return {on_rig.upper, on_rig.lower, on_rig.bone};
  return {on_rig.upper, on_rig.lower};
}

void solve(const ConstraintOnRig& on_rig, PosedRig& rig) {
  const Constraint& constraint = on_rig.constraint;
  const glm::dvec3 place = target_place(on_rig, rig);
  if (!has_planted_end(on_rig)) return bring_joint(on_rig, rig, place);
  const glm::dquat frame = on_rig.target < 0 ? glm::dquat(1, 0, 0, 0) : rig.turn(on_rig.target);
  const glm::dquat direction =
      constraint.keeps_rotation ? glm::normalize(frame * constraint.rotation) : rig.turn(on_rig.bone);
  const Bone& end = rig.armature().bones[on_rig.bone];
  bring_joint(on_rig, rig, constraint.point == PlantPoint::Joint ? place : place - direction * (end.tail - end.head));
  rig.turn_to(on_rig.bone, direction);
}

}  // namespace

bool has_planted_end(const ConstraintOnRig& on_rig) { return on_rig.bone != on_rig.lower; }

glm::dvec3 planted_point(const ConstraintOnRig& on_rig, const PosedRig& rig) {
  const bool by_joint = on_rig.constraint.point == PlantPoint::Joint && has_planted_end(on_rig);
  return by_joint ? rig.head(on_rig.bone) : rig.tail(on_rig.bone);
}

ConstraintRule plant_constraint() {
  return {ConstraintKind::Plant,
          "plant",
          "Plant",
          "Keep a hand or foot at a fixed position in the world or on another bone.",
          ConstraintTarget::Place,
          turned,
          solve};
}

}  // namespace limber
