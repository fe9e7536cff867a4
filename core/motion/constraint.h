// SPDX-License-Identifier: AGPL-3.0-or-later
// Constraints tie bones to targets. They change the pose of a frame after its motion and its keys have made it: a bone
// copies the rotation of another bone, stays within limits or looks at a target; a hand or foot stays at a position; a
// limb reaches for a position by inverse kinematics. Constraints store the names of bones, as keys do, so that a change
// of the rig loses only the constraints of removed bones.
//
// A weight says how much a constraint counts. At 0 the pose of motion and keys stays bit for bit, at 1 the constraint
// holds fully, and between them each bone is slerped from the first pose to the second. Keys of the weight switch
// between forward and inverse kinematics. core/motion/constraint_rule.h lists the kinds, core/motion/constraint_stack.h
// applies the constraints.
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

// The kinds of constraints, as indices into the table of constraint_rule.h. Projects store these numbers.
enum class ConstraintKind : std::uint8_t { CopyRotation, LimitRotation, JointRange, Aim, Plant, InverseKinematics };

// Tells what a rotation is measured from. World: the bone's rest pose in the world. Parent: the rest pose relative to
// the parent bone.
enum class RotationSpace : std::uint8_t { World, Parent };

// A direction along one of a bone's own axes in the rest pose (rest_axes()); y points from head to tail.
enum class BoneAxis : std::uint8_t { PlusX, MinusX, PlusY, MinusY, PlusZ, MinusZ };

struct Constraint {
  std::string name;  // unique among the clip's constraints; the keys of the weight are stored under this name
  ConstraintKind kind = ConstraintKind::CopyRotation;
  bool on = true;
  double weight = 1;  // constant weight, [0, 1]; used if the weight has no keys
  std::string bone;   // the bone that is constrained
  // The target is a bone, or a position in world coordinates, mm. If `target` is empty, the position `place` is fixed
  // in the world; else it is fixed to the bone `target`, and `place` is where it lies in the rest pose.
  std::string target;
  glm::dvec3 place{0};

  // Selects components of a rotation vector about the bone's own axes. Limit rotation limits the selected components.
  // Copy rotation copies only the selected components of the rotation from the bone's own orientation to its target's.
  std::array<bool, 3> axes{true, true, true};
  RotationSpace space = RotationSpace::World;  // copy rotation: what the rotation is measured from
  // Limit rotation: limits about the bone's own axes, radians.
  glm::dvec3 minimum{glm::radians(-30.0)}, maximum{glm::radians(30.0)};
  BoneAxis aim = BoneAxis::PlusY;      // aim: the direction that points at the target
  PlantPoint point = PlantPoint::Tip;  // plant: the point of hand or foot that keeps its position
  bool keeps_rotation = true;          // plant: the hand or foot keeps `rotation` too
  glm::dquat rotation{1, 0, 0, 0};     // plant: rotation from the rest pose, relative to the target
  int chain = 2;                       // inverse kinematics: number of bones that turn; 0: all up to the root
  bool keep_limits = true;             // inverse kinematics: joints stay within their limits

  bool operator==(const Constraint&) const = default;
};

struct Constraints {
  std::vector<Constraint> list;  // in the order that the user set

  bool operator==(const Constraints&) const = default;
};

constexpr std::size_t kMostConstraints = 4096;  // a project whose clip has more constraints is refused as damaged
// When a project is read, coordinates of target positions are cut to this magnitude, mm.
constexpr double kFarthestPlace = 1e7;

// Returns the weight of a constraint at a frame, [0, 1]: from the keys of the weight, or the constraint's constant
// weight if there are none.
double weight_at(const Constraint& constraint, const Keys& keys, int frame);

// Returns the name `wanted`, with a number appended if a constraint has this name already.
std::string unique_constraint_name(const Constraints& constraints, const std::string& wanted);

// Renames constraints that are named after their kind and bone, such as "Plant LeftHand", if they now have another
// bone. The keys of their weights are renamed too.
//   before  the previous bone of each constraint
void name_after_bones(std::vector<Constraint>& list, Keys& keys, const std::vector<std::string>& before);

// Returns the constraint with its position, rotation, axes and limits mirrored. Names stay.
//   bone, counterpart  the constrained bone, and the bone of the mirrored constraint, both in the rest pose
Constraint mirror_image(const Constraint& constraint, const Bone& bone, const Bone& counterpart,
                        const MirrorPlane& plane);

// Returns the constraint for a rig whose rest pose is replaced by `pose` (core/pose/apply_pose_as_rest.h). The position
// and the rotation of the constraint stay the same in the world.
Constraint with_pose_as_rest(const Constraint& constraint, const Armature& armature, const Pose& pose);

}  // namespace limber
