// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes a bone's rotation as three Euler angles, as graph editors show it: rotation = Rz(z) Ry(y) Rx(x), about the
// axes of the parent bone's frame. Angles are in radians. Near y = +-90 degrees the angles x and z are not determined
// (gimbal lock).
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace limber {

// Returns the Euler angles of a rotation. Of the equivalent triples of angles it returns the one nearest to `near`, so
// that curves do not jump.
glm::dvec3 channel_angles(const glm::dquat& rotation, const glm::dvec3& near = glm::dvec3(0));
glm::dquat rotation_of_channels(const glm::dvec3& angles);

// Convert between the rates of change of the angles and the angular velocity in the parent's frame. In gimbal lock some
// velocities cannot be reached; channel_speeds() then returns the smallest rates whose velocity is nearest.
glm::dvec3 velocity_of_channels(const glm::dvec3& angles, const glm::dvec3& speeds);
glm::dvec3 channel_speeds(const glm::dvec3& angles, const glm::dvec3& velocity);

}  // namespace limber
