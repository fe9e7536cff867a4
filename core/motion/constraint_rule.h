// SPDX-License-Identifier: AGPL-3.0-or-later
// The table of the kinds of constraints. Menus, operators and the solver read it. A new kind needs one source file
// core/motion/constraint_KIND.cpp, a line of kRules in constraint_rule.cpp and a value of ConstraintKind.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/motion/constraint.h"
#include "core/motion/posed_rig.h"

namespace limber {

// A constraint together with the indices of its bones in a rig.
struct ConstraintOnRig {
  const Constraint& constraint;
  int bone = 0;
  // Index of the target bone; -1: the target is a position in the world, or this kind of constraint has no target.
  int target = -1;
  // Only for plants: the two long bones of the limb. If the planted bone belongs to no known limb, these are its parent
  // (`lower`) and its grandparent (`upper`). `hinge` is the axis about which the limb bends at rest, in world axes, or
  // zero.
  int upper = -1, lower = -1;
  glm::dvec3 hinge{0};
};

enum class ConstraintTarget : std::uint8_t { None, Bone, Place };

struct ConstraintRule {
  ConstraintKind kind = {};  // equals the rule's index in the table
  std::string id;           // for example "copy_rotation"; the operator that adds one is "constraint.add_copy_rotation"
  std::string name;         // name that the user sees, for example "Copy rotation"
  std::string description;  // a sentence that the user sees
  ConstraintTarget target = {};  // kind of target that the constraint needs; a position may be fixed to a bone

  // Returns the bones that the constraint turns, in no order. Throws Error if the rig lacks a bone that the constraint
  // needs.
  std::vector<int> (*turned)(const ConstraintOnRig& on_rig, const Armature& armature) = nullptr;
  // Turns the bones of turned() so that the constraint holds.
  void (*solve)(const ConstraintOnRig& on_rig, PosedRig& rig) = nullptr;
};

// Returns the table, indexed by ConstraintKind.
std::span<const ConstraintRule> constraint_rules();
const ConstraintRule& constraint_rule(ConstraintKind kind);

// Finds the bones of a constraint. Throws Error with a one-line message if the rig does not have them.
//   limbs  from planted_limbs()
ConstraintOnRig on_rig(const Constraint& constraint, const Armature& armature, const std::vector<PlantedLimb>& limbs);

// Returns the position of the target in a pose, in the world, mm.
glm::dvec3 target_place(const ConstraintOnRig& on_rig, const PosedRig& rig);

// Returns whether the limb of a plant ends with a hand or foot. If not, the tail of the forearm or shank is planted.
bool has_planted_end(const ConstraintOnRig& on_rig);
// Returns where the planted point lies in a pose, in the world, mm.
glm::dvec3 planted_point(const ConstraintOnRig& on_rig, const PosedRig& rig);

// Returns only the constrained bone: most kinds of constraints turn no other.
std::vector<int> turned_alone(const ConstraintOnRig& on_rig, const Armature& armature);

// ---- The kinds, one source file each
ConstraintRule copy_rotation_constraint();
ConstraintRule limit_rotation_constraint();
ConstraintRule joint_range_constraint();
ConstraintRule aim_constraint();
ConstraintRule plant_constraint();
ConstraintRule inverse_kinematics_constraint();

}  // namespace limber
