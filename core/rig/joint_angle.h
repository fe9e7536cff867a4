// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds which angle of a joint changes when a user rotates its bone about an axis, the value of this angle, and the
// range that the joint's limits allow. A hinge has one angle. A ball joint has a twist about the bone and a swing
// across it; the rotation axis decides which of them is returned. Angles are relative to the anatomical position if the
// caller gives the joint's angle at rest (anatomical_position.h), else relative to the rest pose. Angles are in
// radians; axes and rotations are those of joint_limits.h.
#pragma once

#include <optional>
#include <string>

#include "core/rig/joint_limits.h"

namespace limber {

struct JointReading {
  enum class Kind { Flexion, Swing, Twist, Fixed };
  Kind kind = Kind::Fixed;
  double angle = 0, minimum = 0, maximum = 0;
  double sense = 1;  // 1 if a positive rotation about the axis increases the angle, -1 if it decreases the angle
};

const char* name_of(JointReading::Kind kind);  // returns the word for a kind, such as "Flexion"

// Returns the angle of a joint that a rotation about `axis` changes. Returns nothing for a joint without limits, or if
// the axis deviates by more than 60 degrees from the axis of a hinge.
//   axis     unit axis of the rotation
//   at_rest  turn_at_rest(), or zero for angles relative to rest
std::optional<JointReading> read_joint(const Bone& bone, const glm::dquat& rotation, const glm::dvec3& axis,
                                       const glm::dvec3& at_rest = glm::dvec3(0));

// Returns text such as "Flexion 54.0 of 150", or beyond a limit "Flexion -21.5, beyond 0 by 21.5"; each number has a
// degree sign.
std::string text_of(const JointReading& reading);

// Returns the allowed range as text such as "0 to 150", with degree signs.
std::string range_text(const JointReading& reading);

// Returns text that says by how much a rotation exceeds the limits; empty if it does not. For a hinge, the text names
// the excess of its angle and the rotation across its axis: "beyond 0 by 83.1, 34.5 across", with degree signs.
std::string excess_text(const Bone& bone, const glm::dquat& rotation, const glm::dvec3& at_rest);

}  // namespace limber
