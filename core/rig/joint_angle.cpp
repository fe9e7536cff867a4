// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/joint_angle.h"

#include <cmath>
#include <cstdio>

namespace limber {

namespace {

constexpr double kShown = 0.05;  // degrees; smaller angles are not mentioned, since texts show one decimal
// Cosine of 60 degrees. If a rotation axis is at a larger angle to the hinge axis, read_joint() returns nothing.
constexpr double kAcross = 0.5;

}  // namespace

const char* name_of(JointReading::Kind kind) {
  constexpr const char* kNames[] = {"Flexion", "Swing", "Twist", "Fixed"};
  return kNames[static_cast<int>(kind)];
}

std::optional<JointReading> read_joint(const Bone& bone, const glm::dquat& rotation, const glm::dvec3& axis,
                                       const glm::dvec3& at_rest) {
  const JointLimits& limits = bone.limits;
  switch (limits.type) {
    case JointLimits::Type::Free: return std::nullopt;
    case JointLimits::Type::Fixed: return JointReading{};
    case JointLimits::Type::Hinge: {
      const double along = glm::dot(axis, limits.axis);
      if (std::abs(along) < kAcross) return std::nullopt;
      const double zero = glm::dot(at_rest, limits.axis);
      return JointReading{JointReading::Kind::Flexion, swing_twist(rotation, limits.axis).twist + zero,
                          limits.minimum + zero, limits.maximum + zero, along < 0 ? -1.0 : 1.0};
    }
    case JointLimits::Type::Ball: {
      const glm::dvec3 own = twist_axis(bone);
      const SwingTwist parts = swing_twist(rotation, own);
      const double along = glm::dot(axis, own);
      if (2 * along * along > 1)
        return JointReading{JointReading::Kind::Twist, parts.twist, limits.twist_minimum, limits.twist_maximum,
                            along < 0 ? -1.0 : 1.0};
      // The cone limits the length of the whole swing vector. Its component about the other axis therefore reduces the
      // range of this angle.
      const double angle = glm::dot(parts.swing, axis), rest = glm::length(parts.swing - angle * axis);
      const double room = std::sqrt(std::max(0.0, limits.cone * limits.cone - rest * rest));
      const double zero = glm::dot(at_rest, axis);
      return JointReading{JointReading::Kind::Swing, angle + zero, zero - room, zero + room, 1};
    }
  }
  return std::nullopt;
}

std::string text_of(const JointReading& reading) {
  if (reading.kind == JointReading::Kind::Fixed) return "Fixed joint";
  char text[96];
  const double angle = glm::degrees(reading.angle), low = glm::degrees(reading.minimum),
               high = glm::degrees(reading.maximum);
  const bool below = angle<low - kShown, above = angle> high + kShown;
  const char* name = name_of(reading.kind);
  if (below || above)
    std::snprintf(text, sizeof text, "%s %.1f\u00b0, beyond %ld\u00b0 by %.1f\u00b0", name, angle,
                  std::lround(below ? low : high), below ? low - angle : angle - high);
  else
    std::snprintf(text, sizeof text, "%s %.1f\u00b0 of %ld\u00b0", name, std::abs(angle) < kShown ? 0 : angle,
                  std::lround(angle > -kShown || low > -kShown ? high : low));
  return text;
}

std::string range_text(const JointReading& reading) {
  char text[64];
  std::snprintf(text, sizeof text, "%ld\u00b0 to %ld\u00b0", std::lround(glm::degrees(reading.minimum)),
                std::lround(glm::degrees(reading.maximum)));
  return text;
}

std::string excess_text(const Bone& bone, const glm::dquat& rotation, const glm::dvec3& at_rest) {
  const double beyond = glm::degrees(limit_excess(bone, rotation));
  if (beyond <= kShown) return "";
  char text[96];
  if (bone.limits.type != JointLimits::Type::Hinge) {
    std::snprintf(text, sizeof text, "beyond by %.1f\u00b0", beyond);
    return text;
  }
  const JointReading reading = *read_joint(bone, rotation, bone.limits.axis, at_rest);
  const double angle = glm::degrees(reading.angle), low = glm::degrees(reading.minimum),
               high = glm::degrees(reading.maximum);
  const double across = glm::degrees(glm::length(swing_twist(rotation, bone.limits.axis).swing));
  const bool out = angle < low - kShown || angle > high + kShown;
  std::string words;
  if (out) {
    std::snprintf(text, sizeof text, "beyond %ld\u00b0 by %.1f\u00b0", std::lround(angle < low ? low : high),
                  angle < low ? low - angle : angle - high);
    words = text;
  }
  if (across > kShown) {
    std::snprintf(text, sizeof text, out ? ", %.1f\u00b0 across" : "%.1f\u00b0 across the hinge", across);
    words += text;
  }
  return words;
}

}  // namespace limber
