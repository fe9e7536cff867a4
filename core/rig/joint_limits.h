// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests rotations against a joint's limits, and clamps rotations to them. A ball joint's rotation is split into a twist
// about its axis, followed by a swing across the axis,
//   rotation = exp(swing) exp(twist axis),  with the swing at right angles to the axis,
// so that the limits of swing (a cone) and twist (a range) are independent [Grassia 1998, Practical parameterization of
// rotations]. Angles are in radians, axes in world coordinates in the rest pose. Rotations are those of a Pose,
// relative to the rest pose and to the parent bone.
#pragma once

#include <glm/gtc/quaternion.hpp>

#include "core/rig/armature.h"

namespace limber {

struct SwingTwist {
  glm::dvec3 swing{0};  // rotation vector at right angles to the twist axis, radians
  double twist = 0;     // angle about the twist axis, radians, -pi .. pi
};

// swing_twist() splits a rotation into swing and twist; rotation_of() composes the rotation from both.
//   axis  unit axis of the twist
SwingTwist swing_twist(const glm::dquat& rotation, const glm::dvec3& axis);
glm::dquat rotation_of(const SwingTwist& parts, const glm::dvec3& axis);

// Returns the rotation by the angle |v| about the direction of a rotation vector v. For the zero vector this is exactly
// the identity.
glm::dquat exponential(const glm::dvec3& rotation_vector);

// Returns the unit twist axis of a ball joint: the axis in its limits, or the direction of the bone if no axis is set.
glm::dvec3 twist_axis(const Bone& bone);

// Returns `rotation` if the limits allow it, else a near rotation that they allow. For a hinge, this is a rotation
// about its axis, with the angle clamped to its range. For a ball joint, swing and twist are clamped separately.
glm::dquat within_limits(const Bone& bone, const glm::dquat& rotation);

// Returns by how much a rotation exceeds the limits: the angle, radians, between the rotation and the allowed rotation
// that within_limits() returns.
double limit_excess(const Bone& bone, const glm::dquat& rotation);

}  // namespace limber
