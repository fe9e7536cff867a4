// SPDX-License-Identifier: AGPL-3.0-or-later
// What retargeting knows of a body: a rig at rest, or a motion at a frame, by body parts (joint_names), in LPS; where
// it faces, and at which frame of a motion it stands most nearly upright with hanging or spread arms.
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

inline const glm::dvec3 kUp(0, 0, 1);  // LPS: towards the head

inline double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// The shortest turn that takes direction a to direction b; neither need be of unit length.
glm::dquat shortest_turn(const glm::dvec3& a, const glm::dvec3& b);

// Right-handed axes: the third along `main`, the first as near to `side` as it can be.
std::optional<glm::dmat3> axes_of(const glm::dvec3& main, const glm::dvec3& side);

struct Skeleton {
  std::vector<int> parents;
  std::vector<glm::dvec3> place, tip;  // of each joint; the tip is where it points without better knowledge
  std::map<JointRole, int> joint;
  std::vector<std::optional<JointRole>> role;

  std::optional<glm::dvec3> place_of(BodyPart part, BodySide side, int index = 0) const {
    const auto found = joint.find({part, side, index});
    return found == joint.end() ? std::nullopt : std::optional(place[found->second]);
  }
};

Skeleton skeleton_of(const Armature& armature);
Skeleton skeleton_of(const Motion& motion);  // at rest

// Places only; tips are the mean of the children, of their children where those stand on the joint itself, or the End
// Site.
//   frame  -1: the rest pose
void place_joints(Skeleton& skeleton, const Motion& motion, int frame);

// From the joint to where its limb goes on; not of unit length, zero when unknown.
glm::dvec3 direction_of(const Skeleton& skeleton, int joint);

// From the hips up to the neck.
std::optional<glm::dvec3> trunk_line(const Skeleton& skeleton);

// Axes of the body by `part`'s two sides and the trunk.
std::optional<glm::dmat3> body_axes(const Skeleton& skeleton, BodyPart part);

// The moment that offsets are taken from: -1 for the rest pose.
int standing_frame(const Motion& motion, Skeleton skeleton);

}  // namespace limber
