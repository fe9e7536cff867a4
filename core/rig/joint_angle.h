// SPDX-License-Identifier: AGPL-3.0-or-later
// What a joint's limits say of a turn about one axis: the anatomical angle that the turn changes, and how far it may
// go. A hinge has one angle, a ball its twist about the bone and its swing across it; which of them is meant is told by
// the axis nearest to the turn's. Angles count from the anatomical position where `at_rest` tells how far rest is from
// it (anatomical_position.h), else from rest. Radians; axes and rotations as in joint_limits.h.
#pragma once

#include <optional>
#include <string>

#include "core/rig/joint_limits.h"

namespace limber {

struct JointReading {
  enum class Kind { Flexion, Swing, Twist, Fixed };
  Kind kind = Kind::Fixed;
  double angle = 0, minimum = 0, maximum = 0;
  double sense = 1;  // by what a turn of 1 about the axis changes the angle: 1 or -1
};

const char* name_of(JointReading::Kind kind);  // "Flexion"

//   axis  unit
// Nothing for a joint without limits, or a turn across a hinge.
std::optional<JointReading> read_joint(const Bone& bone, const glm::dquat& rotation, const glm::dvec3& axis,
                                       const glm::dvec3& at_rest = glm::dvec3(0));

// "Flexion 54.0° of 150°", and beyond an end "Flexion -21.5°, beyond 0° by 21.5°".
std::string text_of(const JointReading& reading);

// "0° to 150°": what may be read.
std::string range_text(const JointReading& reading);

// By what a rotation breaks the limits, a hinge's angle and what is turned across it apart: "beyond 0° by 83.1°, 34.5°
// across"; "" where it is within.
std::string excess_text(const Bone& bone, const glm::dquat& rotation, const glm::dvec3& at_rest);

}  // namespace limber
