// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/joint_limits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limber {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTolerance = 1e-9;  // radians; a rotation at a limit counts as within it in spite of rounding

double angle_of(const glm::dquat& q) { return 2 * std::atan2(glm::length(glm::dvec3(q.x, q.y, q.z)), std::abs(q.w)); }

double wrapped(double angle) { return std::remainder(angle, 2 * kPi); }

// Returns the angle in [minimum, maximum] that is nearest to `angle`, where angles that differ by full turns are equal.
double cut(double angle, double minimum, double maximum) {
  for (double turn : {0.0, 2 * kPi, -2 * kPi})
    if (angle + turn >= minimum - kTolerance && angle + turn <= maximum + kTolerance) return angle + turn;
  return std::abs(wrapped(angle - minimum)) <= std::abs(wrapped(angle - maximum)) ? minimum : maximum;
}

}  // namespace

glm::dquat exponential(const glm::dvec3& v) {
  const double angle = glm::length(v);
  if (angle == 0) return {1, 0, 0, 0};
  const double scale = angle < 1e-8 ? 0.5 : std::sin(angle / 2) / angle;
  return glm::normalize(glm::dquat(std::cos(angle / 2), scale * v));
}

SwingTwist swing_twist(const glm::dquat& rotation, const glm::dvec3& axis) {
  const glm::dquat q = rotation.w < 0 ? -rotation : rotation;
  const double along = glm::dot(glm::dvec3(q.x, q.y, q.z), axis);
  SwingTwist parts;
  // If the swing is half a turn, the twist is not determined and stays zero.
  if (q.w * q.w + along * along > 1e-24) parts.twist = 2 * std::atan2(along, q.w);
  glm::dquat swing = rotation * glm::conjugate(glm::angleAxis(parts.twist, axis));
  if (swing.w < 0) swing = -swing;
  const glm::dvec3 v(swing.x, swing.y, swing.z);
  const double sine = glm::length(v);
  if (sine > 0) parts.swing = v * (2 * std::atan2(sine, swing.w) / sine);
  parts.swing -= axis * glm::dot(parts.swing, axis);
  return parts;
}

glm::dquat rotation_of(const SwingTwist& parts, const glm::dvec3& axis) {
  return glm::normalize(exponential(parts.swing) * exponential(parts.twist * axis));
}

glm::dvec3 twist_axis(const Bone& bone) {
  if (bone.limits.axis != glm::dvec3(0)) return bone.limits.axis;
  const glm::dvec3 along = bone.tail - bone.head;
  const double length = glm::length(along);
  return length > 0 ? along / length : glm::dvec3(0, 0, 1);
}

glm::dquat within_limits(const Bone& bone, const glm::dquat& rotation) {
  const JointLimits& limits = bone.limits;
  switch (limits.type) {
    case JointLimits::Type::Free: return rotation;
    case JointLimits::Type::Fixed: return {1, 0, 0, 0};
    case JointLimits::Type::Hinge: {
      const SwingTwist parts = swing_twist(rotation, limits.axis);
      const double angle = cut(parts.twist, limits.minimum, limits.maximum);
      const bool allowed =
          glm::length(parts.swing) <= kTolerance && std::abs(wrapped(angle - parts.twist)) <= kTolerance;
      return allowed ? rotation : exponential(angle * limits.axis);
    }
    case JointLimits::Type::Ball: {
      const glm::dvec3 axis = twist_axis(bone);
      SwingTwist parts = swing_twist(rotation, axis);
      const double swing = glm::length(parts.swing),
                   twist = cut(parts.twist, limits.twist_minimum, limits.twist_maximum);
      if (swing <= limits.cone + kTolerance && std::abs(wrapped(twist - parts.twist)) <= kTolerance) return rotation;
      if (swing > limits.cone) parts.swing *= limits.cone / swing;
      parts.twist = twist;
      return rotation_of(parts, axis);
    }
  }
  return rotation;
}

double limit_excess(const Bone& bone, const glm::dquat& rotation) {
  return angle_of(within_limits(bone, rotation) * glm::conjugate(rotation));
}

}  // namespace limber
