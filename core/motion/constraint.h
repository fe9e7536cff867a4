// SPDX-License-Identifier: AGPL-3.0-or-later
// Constraints tie bones to targets. They change the pose of a frame after its motion and its keys have made it: a bone
// turns as another one does, keeps within limits or looks at a target, a hand or foot stays in its place, and a limb
// reaches for one by inverse kinematics. Bones are named, as in keys, so that a change of the rig loses only the
// constraints of removed bones.
//
// A weight says how much a constraint counts. At 0 the pose of motion and keys stays bit for bit, at 1 the constraint
// holds fully, and between them each bone is slerped from the one to the other. Keys of the weight switch between
// forward and inverse kinematics. core/motion/constraint_rule.h lists the kinds, core/motion/constraint_stack.h applies
// them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>

#include "core/motion/keyframes.h"
#include "core/motion/plants.h"
#include "core/rig/mirror.h"

namespace limber {

// The indices of the kinds in the table of constraint_rule.h. Projects hold these numbers.
enum class ConstraintKind : std::uint8_t { CopyRotation, LimitRotation, JointRange, Aim, Plant, InverseKinematics };

// Whether a rotation is that from the rest pose in the world, or relative to the parent bone.
enum class RotationSpace : std::uint8_t { World, Parent };

// A direction along one of a bone's own axes at rest (rest_axes(); y is from head to tail).
enum class BoneAxis : std::uint8_t { PlusX, MinusX, PlusY, MinusY, PlusZ, MinusZ };

struct Constraint {
  std::string name;  // unique among the clip's constraints; keys of the weight are listed by it
  ConstraintKind kind = ConstraintKind::CopyRotation;
  bool on = true;
  double weight = 1;  // where the weight has no keys, [0, 1]
  std::string bone;   // the bone that is constrained
  // The target is a bone, or a place: of the world where `target` is empty, else fixed to that bone. The place is
  // given in the world, mm; that of a bone as it is in the rest pose.
  std::string target;
  glm::dvec3 place{0};

  // Limit rotation: which parts of the rotation vector are limited, about the bone's own axes. Copy rotation: which
  // parts of the turn from the bone's own rotation to its target's are taken.
  std::array<bool, 3> axes{true, true, true};
  RotationSpace space = RotationSpace::World;                            // copy rotation
  glm::dvec3 minimum{glm::radians(-30.0)}, maximum{glm::radians(30.0)};  // limit rotation: about the own axes
  BoneAxis aim = BoneAxis::PlusY;                                        // aim: the direction that points at the target
  PlantPoint point = PlantPoint::Tip;                                    // plant: the point of hand or foot that stays
  bool keeps_rotation = true;                                            // plant: the hand or foot keeps `rotation` too
  glm::dquat rotation{1, 0, 0, 0};                                       // plant: from rest, relative to the target
  int chain = 2;            // inverse kinematics: number of bones that turn; 0: up to the root
  bool keep_limits = true;  // inverse kinematics: joints keep to their limits

  bool operator==(const Constraint&) const = default;
};

struct Constraints {
  std::vector<Constraint> list;  // in the user's order

  bool operator==(const Constraints&) const = default;
};

constexpr std::size_t kMostConstraints = 4096;  // of a clip; far more than a rig has bones
constexpr double kFarthestPlace = 1e7;          // bound of a place's coordinates in a project, mm

// Returns the weight of a constraint at a frame, [0, 1]: that of its keys, or its own where it has none.
double weight_at(const Constraint& constraint, const Keys& keys, int frame);

// Returns the name `wanted`, with a number appended if a constraint has this name already.
std::string unique_constraint_name(const Constraints& constraints, const std::string& wanted);

// Renames the constraints that are named by their kind and bone, as in "Plant LeftHand", where they went over to
// another bone; keys of their weights go along.
//   before  for each constraint, the bone that it had
void name_after_bones(std::vector<Constraint>& list, Keys& keys, const std::vector<std::string>& before);

// Returns the constraint with its place, rotation, axes and limits mirrored. Names stay.
//   bone, counterpart  the bone that is constrained, and the one that the mirrored constraint belongs to, at rest
Constraint mirror_image(const Constraint& constraint, const Bone& bone, const Bone& counterpart,
                        const MirrorPlane& plane);

// Returns the constraint for the rig that has the pose as its rest pose (core/pose/apply_pose_as_rest.h): its place and
// rotation are the same in the world.
Constraint with_pose_as_rest(const Constraint& constraint, const Armature& armature, const Pose& pose);

}  // namespace limber
