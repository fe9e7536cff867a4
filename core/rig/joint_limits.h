// SPDX-License-Identifier: AGPL-3.0-or-later
// What a joint's limits allow. A ball's rotation is read as a twist about its axis followed by a swing across it,
//   rotation = exp(swing) exp(twist axis),  swing at right angles to the axis,
// the split in which a cone and a range of twist are independent [Grassia 1998, Practical parameterization of
// rotations]. Angles in radians, axes in the world at rest, rotations relative to rest and to the parent, as in a Pose.
#pragma once

#include <glm/gtc/quaternion.hpp>

#include "core/rig/armature.h"

namespace limber {

struct SwingTwist {
  glm::dvec3 swing{0};  // rotation vector at right angles to the axis
  double twist = 0;     // -pi .. pi
};

//   axis  unit
SwingTwist swing_twist(const glm::dquat& rotation, const glm::dvec3& axis);
glm::dquat rotation_of(const SwingTwist& parts, const glm::dvec3& axis);

// exp of a rotation vector, exactly the identity for zero.
glm::dquat exponential(const glm::dvec3& rotation_vector);

// The unit twist axis of a ball: its own, or along the bone.
glm::dvec3 twist_axis(const Bone& bone);

// The rotation nearest to `rotation` that the limits allow: hinges keep their angle about the axis, balls their swing
// and twist, each cut to its range. `rotation` itself where it is allowed.
glm::dquat within_limits(const Bone& bone, const glm::dquat& rotation);

// By how much a rotation exceeds the limits: the angle to within_limits.
double limit_excess(const Bone& bone, const glm::dquat& rotation);

}  // namespace limber
