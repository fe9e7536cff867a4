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

// A constraint with its bones found in a rig.
struct ConstraintOnRig {
  const Constraint& constraint;
  int bone = 0;
  int target = -1;  // -1: the target is a place of the world, or the kind has none
  // Plant: the bones of the limb, or the two bones above where the bone ends no limb that is known by its name. The
  // axis about which the limb bends at rest, world, or zero.
  int upper = -1, lower = -1;
  glm::dvec3 hinge{0};
};

enum class ConstraintTarget : std::uint8_t { None, Bone, Place };

struct ConstraintRule {
  ConstraintKind kind = {};      // the rule's index in the table
  std::string id;                // as in "copy_rotation"; the operator that adds one is "constraint.add_copy_rotation"
  std::string name;              // as in "Copy rotation"
  std::string description;       // for the user, as a sentence
  ConstraintTarget target = {};  // what a constraint of this kind needs; a place may be that of a bone

  // Returns the bones that the constraint turns, in no order. Throws Error where the rig lacks bones for it.
  std::vector<int> (*turned)(const ConstraintOnRig& on_rig, const Armature& armature) = nullptr;
  // Turns these bones so that the constraint holds.
  void (*solve)(const ConstraintOnRig& on_rig, PosedRig& rig) = nullptr;
};

// Returns the table, indexed by ConstraintKind.
std::span<const ConstraintRule> constraint_rules();
const ConstraintRule& constraint_rule(ConstraintKind kind);

// Finds the bones of a constraint. Throws Error with one line where the rig does not have them.
//   limbs  from planted_limbs()
ConstraintOnRig on_rig(const Constraint& constraint, const Armature& armature, const std::vector<PlantedLimb>& limbs);

// Returns the place of the target in a pose, world, mm.
glm::dvec3 target_place(const ConstraintOnRig& on_rig, const PosedRig& rig);

// Of a plant: returns whether a hand or foot ends the limb. Otherwise the forearm or shank is planted by its tail.
bool has_planted_end(const ConstraintOnRig& on_rig);
// Returns the point of a planted bone that stays, in a pose, world, mm.
glm::dvec3 planted_point(const ConstraintOnRig& on_rig, const PosedRig& rig);

// Returns the bone alone, as most kinds turn nothing else.
std::vector<int> turned_alone(const ConstraintOnRig& on_rig, const Armature& armature);

// ---- The kinds, one source file each
ConstraintRule copy_rotation_constraint();
ConstraintRule limit_rotation_constraint();
ConstraintRule joint_range_constraint();
ConstraintRule aim_constraint();
ConstraintRule plant_constraint();
ConstraintRule inverse_kinematics_constraint();

}  // namespace limber
