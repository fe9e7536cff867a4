// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/euler_channels.h"

#include <cmath>

#include "core/motion/motion_edit.h"

namespace limber {

namespace {

constexpr std::array<int, 3> kOrder = {2, 1, 0};  // axes of the rotations in the product Rz Ry Rx
constexpr double kLocked = 1e-6;                  // |cos y| below this counts as gimbal lock

glm::dquat about(int axis, double angle) {
  glm::dquat q(std::cos(angle / 2), 0, 0, 0);
  (axis == 0 ? q.x : axis == 1 ? q.y : q.z) = std::sin(angle / 2);
  return q;
}

// Returns the axes about which the angles x, y and z turn, as columns, in the parent's frame.
glm::dmat3 axes_of(const glm::dvec3& angles) {
  const double cy = std::cos(angles.y), sy = std::sin(angles.y), cz = std::cos(angles.z), sz = std::sin(angles.z);
  return {{cz * cy, sz * cy, -sy}, {-sz, cz, 0}, {0, 0, 1}};
}

}  // namespace

glm::dvec3 channel_angles(const glm::dquat& rotation, const glm::dvec3& near) {
  const glm::dvec3 zyx = euler_angles(rotation, kOrder, {near.z, near.y, near.x});
  return {zyx.z, zyx.y, zyx.x};
}

glm::dquat rotation_of_channels(const glm::dvec3& angles) {
  return glm::normalize(about(2, angles.z) * about(1, angles.y) * about(0, angles.x));
}

glm::dvec3 velocity_of_channels(const glm::dvec3& angles, const glm::dvec3& speeds) { return axes_of(angles) * speeds; }

glm::dvec3 channel_speeds(const glm::dvec3& angles, const glm::dvec3& velocity) {
  const glm::dmat3 axes = axes_of(angles);
  const double cy = std::cos(angles.y), across = glm::dot(axes[1], velocity);
  if (std::abs(cy) < kLocked) {
    // In gimbal lock x rotates about the same axis as z, or the opposite one. Each of the two takes half of the
    // velocity about z.
    const double half = velocity.z / 2;
    return {axes[0].z < 0 ? -half : half, across, half};
  }
  const double x = (std::cos(angles.z) * velocity.x + std::sin(angles.z) * velocity.y) / cy;
  return {x, across, velocity.z + std::sin(angles.y) * x};
}

}  // namespace limber
