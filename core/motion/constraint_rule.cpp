// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/constraint_rule.h"

#include <algorithm>

#include "core/base/error.h"

namespace limber {

namespace {

std::vector<ConstraintRule> numbered(std::vector<ConstraintRule> rules) {
  std::sort(rules.begin(), rules.end(), [](const auto& a, const auto& b) { return a.kind < b.kind; });
  return rules;
}

int bone_named(const Armature& armature, const Constraint& constraint, const std::string& name) {
  if (const auto bone = armature.find(name)) return *bone;
  throw Error("the rig has no bone \"" + name + "\"", constraint.name, "choose another bone, or remove the constraint");
}

// Sets the bones of the limb to which the planted bone of `found` belongs. The planted bone is the limb's foot or hand
// or, if the rig has none, the shank or forearm.
void find_limb(ConstraintOnRig& found, const Armature& armature, const std::vector<PlantedLimb>& limbs) {
  for (const PlantedLimb& limb : limbs) {
    if (found.bone != (limb.end >= 0 ? limb.end : limb.lower)) continue;
    found.upper = limb.upper;
    found.lower = limb.lower;
    found.hinge = limb.hinge;
    return;
  }
  found.lower = armature.bones[found.bone].parent;
  found.upper = found.lower < 0 ? -1 : armature.bones[found.lower].parent;
  if (found.upper < 0)
    throw Error("a plant needs two bones above the bone", found.constraint.name, "choose a hand or foot");
  const Bone& lower = armature.bones[found.lower];
  found.hinge =
      lower.limits.type == JointLimits::Type::Hinge
          ? lower.limits.axis
          : glm::cross(lower.head - armature.bones[found.upper].head, armature.bones[found.bone].head - lower.head);
  if (const double length = glm::length(found.hinge); length > 0) found.hinge /= length;
}

}  // namespace

std::span<const ConstraintRule> constraint_rules() {
  static const std::vector<ConstraintRule> kRules = numbered({
      copy_rotation_constraint(),
      limit_rotation_constraint(),
      joint_range_constraint(),
      aim_constraint(),
      plant_constraint(),
      inverse_kinematics_constraint(),
  });
  return kRules;
}

const ConstraintRule& constraint_rule(ConstraintKind kind) {
  return constraint_rules()[static_cast<std::size_t>(kind)];
}

ConstraintOnRig on_rig(const Constraint& constraint, const Armature& armature, const std::vector<PlantedLimb>& limbs) {
  ConstraintOnRig found{constraint};
  const ConstraintTarget needed = constraint_rule(constraint.kind).target;
  found.bone = bone_named(armature, constraint, constraint.bone);
  if (needed != ConstraintTarget::None && !constraint.target.empty())
    found.target = bone_named(armature, constraint, constraint.target);
  if (needed == ConstraintTarget::Bone && found.target < 0)
    throw Error("the constraint has no target", constraint.name, "choose a bone as its target");
  if (constraint.kind == ConstraintKind::Plant) find_limb(found, armature, limbs);
  return found;
}

glm::dvec3 target_place(const ConstraintOnRig& on_rig, const PosedRig& rig) {
  return on_rig.target < 0 ? on_rig.constraint.place : rig.posed(on_rig.target) * on_rig.constraint.place;
}

std::vector<int> turned_alone(const ConstraintOnRig& on_rig, const Armature&) { return {on_rig.bone}; }

}  // namespace limber
