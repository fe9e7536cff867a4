// SPDX-License-Identifier: AGPL-3.0-or-later
// A skeleton at rest: bones with head and tail in the world (LPS, mm), parents before children.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace limber {

// What a joint (a bone's head) may do, relative to rest. Axes in the world at rest; angles in radians.
struct JointLimits {
  enum class Type { Free, Fixed, Hinge, Ball };
  Type type = Type::Free;
  glm::dvec3 axis{
      0};  // hinge: unit rotation axis, positive bends further; ball: unit twist axis (zero = along the bone)
  double minimum = 0, maximum = 0;              // hinge: angle range
  double cone = 0;                              // ball: largest swing away from rest
  double twist_minimum = 0, twist_maximum = 0;  // ball

  bool operator==(const JointLimits&) const = default;
};

struct Bone {
  std::string name;
  int parent = -1;
  glm::dvec3 head{0}, tail{0};
  double roll = 0;  // Blender's: turn of the bone's x and z axes about its y axis (head to tail), radians
  JointLimits limits;

  bool operator==(const Bone&) const = default;
};

struct Armature {
  std::vector<Bone> bones;

  bool operator==(const Armature&) const = default;
  std::optional<int> find(std::string_view name) const;  // exact name
};

// The bone of that name. Throws Error naming the nearest names when there is none.
int require_bone(const Armature& armature, std::string_view name);

// Throws Error for no bones, more than 4096 bones, a parent at or after its child, an empty or repeated name, a
// position that is not finite. `where` names the file.
void check_armature(const Armature& armature, const std::string& where);

// The bones with parents before children, which otherwise stay in the order given; `parent` may point anywhere in
// `bones`. Throws Error for a parent that is not among them, or bones that are their own ancestors.
Armature parents_first(std::vector<Bone> bones, const std::string& where);

// Blender's bone matrix: columns x, y, z, with y from head to tail and the roll applied [vec_roll_to_mat3].
glm::dmat3 rest_axes(const Bone& bone);

// The roll that makes rest_axes(bone) agree with `x`, the bone's own x axis (unit, across the bone).
double roll_of(const Bone& bone, const glm::dvec3& x);

// Unit axis that `--flex` turns a bone about: its hinge axis if it has one, else (direction of its parent) x
// (direction of the bone), so that positive bends further. Throws Error when there is no hinge and the two enclose
// less than 10 degrees.
glm::dvec3 flex_axis(const Armature& armature, int bone);

// Distance in mm from p to the segment head..tail.
double distance_to_bone(const Bone& bone, const glm::dvec3& p);

}  // namespace limber
