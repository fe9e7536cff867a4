// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests rotations against a joint's limits, and clamps rotations to them. A ball joint's rotation is split into a twist
// about its axis, followed by a swing across the axis,
//   rotation = exp(swing) exp(twist axis),  with the swing at right angles to the axis,
// so that a cone and a range of twist are independent [Grassia 1998, Practical parameterization of rotations]. Angles
// are in radians, axes in the world at rest, rotations relative to rest and to the parent, as in a Pose.
#pragma once

#include <glm/gtc/quaternion.hpp>

#include "core/rig/armature.h"

namespace limber {

struct SwingTwist {
  glm::dvec3 swing{0};  // rotation vector at right angles to the axis
  double twist = 0;     // in radians, -pi .. pi
};

// Splits a rotation into swing and twist (swing_twist), or joins the two (rotation_of).
//   axis  unit
SwingTwist swing_twist(const glm::dquat& rotation, const glm::dvec3& axis);
glm::dquat rotation_of(const SwingTwist& parts, const glm::dvec3& axis);

// Returns the rotation that a rotation vector describes; exactly the identity for zero.
glm::dquat exponential(const glm::dvec3& rotation_vector);

// Returns the unit twist axis of a ball joint: that of its limits, or the direction of the bone if they have none.
glm::dvec3 twist_axis(const Bone& bone);

// Returns `rotation` if the limits allow it, else a near rotation that they allow: of a hinge, only the angle about its
// axis; of a ball, its swing and twist, each clamped to its range.
glm::dquat within_limits(const Bone& bone, const glm::dquat& rotation);

// Returns by how much a rotation exceeds the limits: the angle in radians between it and within_limits().
double limit_excess(const Bone& bone, const glm::dquat& rotation);

}  // namespace limber
