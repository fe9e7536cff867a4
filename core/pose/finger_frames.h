// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds, from the bones of a hand at rest, the direction of the hand, the side to which its palm faces, and the axes
// about which its fingers bend and spread.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/motion/body_frame.h"
#include "core/pose/anatomical_frames.h"

namespace limber {

// The angles of one finger joint, radians.
struct FingerAngles {
  double flexion = 0, spread = 0;
};

// Returns the angles of a finger joint for the rotation of its bone, relative to rest and to the parent. Ignores a
// rotation about the finger's length, which no joint angle describes.
FingerAngles finger_angles(const AnatomicalHinge& hinge, const glm::dquat& rotation);
// Returns the rotation of a finger's bone, relative to rest and to the parent, for the angles of its joint.
glm::dquat rotation_of_finger(const AnatomicalHinge& hinge, const FingerAngles& angles);

// Returns the vector from the wrist to the middle finger's knuckle. Without this knuckle, the vector ends at the mean
// of the other knuckles. Returns nothing for a hand without fingers or wrist.
std::optional<glm::dvec3> along_hand(const Skeleton& skeleton, BodySide side);

// Returns the vector across the palm from the index finger to the little finger, or away from the thumb if there is no
// other finger. The vector is not normalized. Returns nothing for a hand without fingers.
std::optional<glm::dvec3> across_palm(const Skeleton& skeleton, BodySide side);

// Returns true if the rig's only hand, whose bone names tell no side, is a right hand. The direction in which the
// fingers curl decides; returns nothing if they are straight.
std::optional<bool> is_right_hand(const Skeleton& skeleton);

// Returns the hinge of each finger bone of a hand, with the bone's index. A curled finger bends further in the plane in
// which it is curled, a straight finger about the line across the palm. The spread of a finger is measured from its
// metacarpal, or from the line from wrist to knuckle if the rig has no metacarpal. A thumb spreads out of the palm's
// plane.
std::vector<std::pair<int, AnatomicalHinge>> finger_hinges(const Armature& armature, const Skeleton& skeleton,
                                                           BodySide side, bool right);

}  // namespace limber
