// SPDX-License-Identifier: AGPL-3.0-or-later
// Describes a body for retargeting: the joint positions of a rig at rest, or of a motion at one frame, found by body
// part (joint_names.h), in LPS axes. Also computes the axes of the body, and the frame of a motion at which the body
// stands most nearly upright with hanging or spread arms.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "core/motion/bvh.h"
#include "core/rig/armature.h"
#include "core/rig/joint_names.h"

namespace limber {

inline const glm::dvec3 kUp(0, 0, 1);  // direction towards the head in LPS axes

inline double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// Returns the shortest rotation that takes direction a to direction b; neither needs unit length. Returns the identity
// if one of them is the zero vector.
glm::dquat shortest_turn(const glm::dvec3& a, const glm::dvec3& b);

// Returns a right-handed orthonormal frame whose third axis points along `main` and whose first axis is as near to
// `side` as possible. Returns nothing when the two vectors are almost parallel, or one of them is too short.
std::optional<glm::dmat3> axes_of(const glm::dvec3& main, const glm::dvec3& side);

struct Skeleton {
  std::vector<int> parents;
  // Position of each joint, and position of the far end (tip) of its bone. The tip gives the bone's direction where no
  // joint follows.
  std::vector<glm::dvec3> place, tip;
  std::map<JointRole, int> joint;
  std::vector<std::optional<JointRole>> role;

  std::optional<glm::dvec3> place_of(BodyPart part, BodySide side, int index = 0) const {
    const auto found = joint.find({part, side, index});
    return found == joint.end() ? std::nullopt : std::optional(place[found->second]);
  }
};

Skeleton skeleton_of(const Armature& armature);
Skeleton skeleton_of(const Motion& motion);  // the skeleton in the motion's rest pose

// Sets the positions of the joints and of their bones' tips at a frame. The tip is the mean position of the joint's
// children, or the joint's End Site. A child that lies at the joint's own position counts with its own tip instead.
//   frame  -1: the rest pose
void place_joints(Skeleton& skeleton, const Motion& motion, int frame);

// Returns the vector from the joint to the next joint or the tip of its limb. The vector is not normalized; it is zero
// when the direction is unknown.
glm::dvec3 direction_of(const Skeleton& skeleton, int joint);

// Returns the vector from the hips up to the neck; nothing if the skeleton lacks the joints for it.
std::optional<glm::dvec3> trunk_line(const Skeleton& skeleton);

// Returns the body's axes (left, back, up), found from the left and right joint of `part` and from the trunk line;
// nothing if the skeleton lacks them.
std::optional<glm::dmat3> body_axes(const Skeleton& skeleton, BodyPart part);

// Returns the frame of the motion at which the body is nearest to standing, or -1 if the rest pose is. Retargeting
// measures the constant rotations between joints and bones in this pose.
int standing_frame(const Motion& motion, Skeleton skeleton);

}  // namespace limber
