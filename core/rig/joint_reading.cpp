// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/joint_reading.h"

#include <cmath>

namespace limber {

namespace {

constexpr double kAcross = 0.5;  // cosine of 60 degrees: a turn further off the hinge's axis is no flexion

}  // namespace

const char* name_of(JointReading::Kind kind) {
  constexpr const char* kNames[] = {"Flexion", "Swing", "Twist", "Fixed"};
  return kNames[static_cast<int>(kind)];
}

std::optional<JointReading> read_joint(const Bone& bone, const glm::dquat& rotation, const glm::dvec3& axis) {
  const JointLimits& limits = bone.limits;
  switch (limits.type) {
    case JointLimits::Type::Free: return std::nullopt;
    case JointLimits::Type::Fixed: return JointReading{};
    case JointLimits::Type::Hinge: {
      const double along = glm::dot(axis, limits.axis);
      if (std::abs(along) < kAcross) return std::nullopt;
      return JointReading{JointReading::Kind::Flexion, swing_twist(rotation, limits.axis).twist, limits.minimum, limits.maximum, along < 0 ? -1.0 : 1.0};
    }
    case JointLimits::Type::Ball: {
      const glm::dvec3 own = twist_axis(bone);
      const SwingTwist parts = swing_twist(rotation, own);
      const double along = glm::dot(axis, own);
      if (2 * along * along > 1) return JointReading{JointReading::Kind::Twist, parts.twist, limits.twist_minimum, limits.twist_maximum, along < 0 ? -1.0 : 1.0};
      // What the swing across this axis leaves of the cone.
      const double angle = glm::dot(parts.swing, axis), rest = glm::length(parts.swing - angle * axis);
      const double room = std::sqrt(std::max(0.0, limits.cone * limits.cone - rest * rest));
      return JointReading{JointReading::Kind::Swing, angle, -room, room, 1};
    }
  }
  return std::nullopt;
}

}  // namespace limber
