// SPDX-License-Identifier: AGPL-3.0-or-later
// Represents a rigid transform as a screw motion at constant speed: a rotation about an axis with a translation along
// that axis [Chasles 1830; logarithm as in Murray, Li & Sastry, A Mathematical Introduction to Robotic Manipulation,
// 1994, appendix A]. After one unit of time the motion has completed the transform.
#pragma once

#include <cmath>

#include "core/base/rigid_transform.h"

namespace limber {

struct Screw {
  glm::dvec3 turn{0};       // rotation vector (direction: the axis; length: the angle in radians, at most half a turn)
  glm::dvec3 at_origin{0};  // velocity of the body point that lies at the origin, mm per unit of time

  // Returns the velocity of the body point that lies at p, mm per unit of time.
  glm::dvec3 velocity(const glm::dvec3& p) const { return glm::cross(turn, p) + at_origin; }
};

inline Screw screw_of(const RigidTransform& transform) {
  const glm::dquat q = transform.rotation.w < 0 ? -transform.rotation : transform.rotation;
  const glm::dvec3 axis(q.x, q.y, q.z);
  const double sine = glm::length(axis), angle = 2 * std::atan2(sine, q.w);
  Screw screw;
  screw.turn = (sine > 1e-12 ? angle / sine : 2.0) * axis;
  const double bent = angle > 1e-3 ? (1 - 0.5 * angle / std::tan(0.5 * angle)) / (angle * angle) : 1.0 / 12;
  const glm::dvec3 across = glm::cross(screw.turn, transform.translation);
  screw.at_origin = transform.translation - 0.5 * across + bent * glm::cross(screw.turn, across);
  return screw;
}

}  // namespace limber
