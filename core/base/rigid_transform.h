// SPDX-License-Identifier: AGPL-3.0-or-later
// A rigid transform: a rotation followed by a translation, p' = R p + t, in mm. A variable of this type is named
// RESULT_from_ARGUMENT, so that code reads as a product:
//   posed_point = posed_from_rest * rest_point
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace limber {

struct RigidTransform {
  glm::dquat rotation{1, 0, 0, 0};  // unit quaternion
  glm::dvec3 translation{0};
};

inline glm::dvec3 operator*(const RigidTransform& t, const glm::dvec3& p) { return t.rotation * p + t.translation; }

// Composes two transforms: (a * b) p = a (b p).
inline RigidTransform operator*(const RigidTransform& a, const RigidTransform& b) {
  return {glm::normalize(a.rotation * b.rotation), a.rotation * b.translation + a.translation};
}

inline RigidTransform inverse(const RigidTransform& t) {
  const glm::dquat back = glm::conjugate(t.rotation);
  return {back, -(back * t.translation)};
}

// Returns the rotation about the fixed point `point`. The result is exactly the identity when `rotation` is the
// identity.
inline RigidTransform rotation_about(const glm::dvec3& point, const glm::dquat& rotation) {
  if (rotation == glm::dquat(1, 0, 0, 0)) return {};
  return {rotation, point - rotation * point};
}

}  // namespace limber
