// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds from a hand's bones at rest where it points, where its palm faces, and about which axes its fingers bend.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/motion/body_frame.h"
#include "core/pose/anatomical_frames.h"

namespace limber {

// Returns the vector from the wrist to the middle finger's knuckle, else to the mean of the other knuckles; nothing
// without fingers or a wrist.
std::optional<glm::dvec3> along_hand(const Skeleton& skeleton, BodySide side);

// Returns the vector across the palm from the index finger to the little finger, or away from the thumb if there is no
// other finger. The vector is not normalized.
std::optional<glm::dvec3> across_palm(const Skeleton& skeleton, BodySide side);

// Tells whether a hand without a side in its names is a right hand, judged by the direction in which its fingers curl.
// Returns nothing if they are straight.
std::optional<bool> is_right_hand(const Skeleton& skeleton);

// Returns a hinge for each finger bone of a hand. A curled finger bends in the plane of its curl, a straight one about
// the line across the palm. Fingers stay spread as they are.
std::vector<std::pair<int, AnatomicalHinge>> finger_hinges(const Armature& armature, const Skeleton& skeleton,
                                                           BodySide side, bool right);

}  // namespace limber
