// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds from a hand's bones at rest where it points, where its palm faces, and about which axes its fingers bend and
// spread.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/motion/body_frame.h"
#include "core/pose/anatomical_frames.h"

namespace limber {

// The angles of a joint of a finger, radians.
struct FingerAngles {
  double flexion = 0, spread = 0;
};

// Returns the angles that a rotation of a finger's bone, relative to rest and to its parent, gives to its joint. A turn
// about the finger's length is not an angle of the joint and is left out.
FingerAngles finger_angles(const AnatomicalHinge& hinge, const glm::dquat& rotation);
// Returns the rotation, relative to rest and to the parent, of a finger's bone with these angles.
glm::dquat rotation_of_finger(const AnatomicalHinge& hinge, const FingerAngles& angles);

// Returns the vector from the wrist to the middle finger's knuckle. Without this knuckle, the vector ends at the mean
// of the other knuckles. Returns nothing for a hand without fingers or wrist.
std::optional<glm::dvec3> along_hand(const Skeleton& skeleton, BodySide side);

// Returns the vector across the palm from the index finger to the little finger, or away from the thumb if there is no
// other finger. The vector is not normalized.
std::optional<glm::dvec3> across_palm(const Skeleton& skeleton, BodySide side);

// Returns true if the rig's only hand, whose bone names tell no side, is a right hand. The direction in which the
// fingers curl decides; returns nothing if they are straight.
std::optional<bool> is_right_hand(const Skeleton& skeleton);

// Returns the hinge of each finger bone of a hand, with the bone's index. A curled finger bends further in the plane in
// which it is curled, a straight finger about the line across the palm. A finger spreads from the line of its
// metacarpal, or of the line from the wrist to its knuckle if the rig has no metacarpal; a thumb out of the palm's
// plane.
std::vector<std::pair<int, AnatomicalHinge>> finger_hinges(const Armature& armature, const Skeleton& skeleton,
                                                           BodySide side, bool right);

}  // namespace limber
