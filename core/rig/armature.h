// SPDX-License-Identifier: AGPL-3.0-or-later
// A skeleton at rest: a list of bones with head and tail in the world (LPS, mm). Parents come before their children.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace limber {

// The limits of a joint (at a bone's head), relative to rest. Axes are in the world at rest, angles in radians.
struct JointLimits {
  enum class Type { Free, Fixed, Hinge, Ball };
  Type type = Type::Free;
  // Hinge: unit rotation axis; a positive angle bends further. Ball: unit twist axis; zero: the direction of the bone.
  glm::dvec3 axis{0};
  double minimum = 0, maximum = 0;              // hinge: range of the angle
  double cone = 0;                              // ball: largest swing away from rest
  double twist_minimum = 0, twist_maximum = 0;  // ball: range of the twist

  bool operator==(const JointLimits&) const = default;
};

struct Bone {
  std::string name;
  int parent = -1;
  glm::dvec3 head{0}, tail{0};
  double roll = 0;  // rotation of the bone's x and z axes about its y axis (head to tail), as in Blender; radians
  JointLimits limits;

  bool operator==(const Bone&) const = default;
};

struct Armature {
  std::vector<Bone> bones;

  bool operator==(const Armature&) const = default;
  std::optional<int> find(std::string_view name) const;  // index of the bone with exactly this name
};

// Returns the index of the bone with this name. Throws Error if there is none; the message lists names of the rig's
// bones.
int require_bone(const Armature& armature, std::string_view name);

// Checks a rig. Throws Error if it has no bones or more than 4096, a bone listed before its parent, an empty or
// repeated name, or a position that is not finite or more than 1000 km away.
//   where  names the file in the error's message
void check_armature(const Armature& armature, const std::string& where);

// Sorts bones so that parents come before children; keeps the order if they already do. Each `parent` is an index into
// `bones`. Throws Error if a parent is not among them, or if a bone is its own ancestor.
Armature parents_first(std::vector<Bone> bones, const std::string& where);

// Returns the bone's own axes as in Blender: columns x, y, z, with y from head to tail and the roll applied
// [vec_roll_to_mat3].
glm::dmat3 rest_axes(const Bone& bone);

// Returns the roll that makes `x` (unit, perpendicular to the bone) the x axis of rest_axes(bone).
double roll_of(const Bone& bone, const glm::dvec3& x);

// Returns the unit axis about which the command-line option --flex rotates a bone: the bone's hinge axis, if it has
// one. Otherwise it is the cross product of the directions of the parent and the bone, so that a positive angle bends
// further. Throws Error if there is no hinge and the bone has no parent, or the angle between the two is below 10
// degrees.
glm::dvec3 flex_axis(const Armature& armature, int bone);

// Returns the distance in mm from p to the line segment from head to tail.
double distance_to_bone(const Bone& bone, const glm::dvec3& p);

}  // namespace limber
