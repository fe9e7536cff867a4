// SPDX-License-Identifier: AGPL-3.0-or-later
// An armature (rig): a skeleton at rest, stored as a list of bones with head and tail in the world (LPS, mm). Parents
// come before their children.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace limber {

// The limits of the joint at a bone's head, relative to the rest pose. Axes are in world coordinates in the rest pose,
// angles in radians.
struct JointLimits {
  enum class Type { Free, Fixed, Hinge, Ball };
  Type type = Type::Free;
  // Hinge: unit rotation axis; a positive angle bends the joint further. Ball: unit twist axis; zero means the bone's
  // direction.
  glm::dvec3 axis{0};
  double minimum = 0, maximum = 0;              // range of a hinge's angle
  double cone = 0;                              // largest swing of a ball joint away from rest
  double twist_minimum = 0, twist_maximum = 0;  // range of a ball joint's twist

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
  std::optional<int> find(std::string_view name) const;  // returns the index of the bone with exactly this name
};

// Returns the index of the bone with this name. Throws Error if there is none; the message lists names of the rig's
// bones.
int require_bone(const Armature& armature, std::string_view name);

// Checks a rig. Throws Error if it has no bones or more than 4096, a bone listed before its parent, an empty or
// repeated name, or a position that is not finite or more than 1000 km away.
//   where  names the file in the error's message
void check_armature(const Armature& armature, const std::string& where);

// Sorts bones so that parents come before children, and adapts their parent indices. Does not change an order that
// already fulfils this. Throws Error if a parent is not an index into `bones`, or if a bone is its own ancestor.
//   where  names the file in the error's message
Armature parents_first(std::vector<Bone> bones, const std::string& where);

// Returns the bone's own axes in the rest pose, with Blender's definition [vec_roll_to_mat3]: columns x, y, z, with y
// from head to tail, and x and z rotated about y by the bone's roll.
glm::dmat3 rest_axes(const Bone& bone);

// Returns the roll that makes `x` (unit, perpendicular to the bone) the x axis of rest_axes(bone).
double roll_of(const Bone& bone, const glm::dvec3& x);

// Returns the unit axis about which the command-line option --flex rotates a bone. It is the bone's hinge axis, or for
// a bone without a hinge the cross product of the directions of parent and bone, so that a positive angle bends
// further. Throws Error for a bone without a hinge that has no parent or is bent by less than 10 degrees against its
// parent.
glm::dvec3 flex_axis(const Armature& armature, int bone);

// Returns the distance in mm from p to the line segment from head to tail.
double distance_to_bone(const Bone& bone, const glm::dvec3& p);

}  // namespace limber
