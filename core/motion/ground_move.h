// SPDX-License-Identifier: AGPL-3.0-or-later
// Moves a posed body along the ground and turns it about the vertical, so that one take continues where another ends.
#pragma once

#include "core/rig/pose.h"

namespace limber {

struct GroundMove {
  double turn = 0;            // angle about the vertical (z), radians
  glm::dvec3 from{0}, to{0};  // the point about which the body turns, and the position to which this point moves, mm

  glm::dquat rotation() const { return glm::angleAxis(turn, glm::dvec3(0, 0, 1)); }
  glm::dvec3 place(const glm::dvec3& p) const { return to + rotation() * (p - from); }
  bool operator==(const GroundMove&) const = default;
};

// Returns the index of the rig's root bone. Throws Error for a rig with several root bones, which cannot turn as one.
int only_root(const Armature& armature);

// Returns the position of the root bone's head in a pose, in the world, mm.
glm::dvec3 root_place(const Armature& armature, const Pose& pose);

// Returns the move that gives the body in `pose` the ground position and the heading that it has in `wanted`. The body
// keeps its height and its lean: only the rotation about the vertical is taken over from the root bone.
GroundMove move_to(const Armature& armature, const Pose& pose, const Pose& wanted);
Pose moved(const Armature& armature, Pose pose, const GroundMove& move);

}  // namespace limber
