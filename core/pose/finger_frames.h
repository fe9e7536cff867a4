// SPDX-License-Identifier: AGPL-3.0-or-later
// What a hand's bones at rest tell: where it points, where its palm faces, and about which axes its fingers bend.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/motion/body_frame.h"
#include "core/pose/anatomical_frames.h"

namespace limber {

// From the wrist to the middle finger's knuckle, or to what there is of knuckles; nothing without fingers or a wrist.
std::optional<glm::dvec3> along_hand(const Skeleton& skeleton, BodySide side);

// From the index finger to the little one; away from the thumb where it is the only one. Not of unit length.
std::optional<glm::dvec3> across_palm(const Skeleton& skeleton, BodySide side);

// Of a hand whose names say no side: told by where its fingers curl.
std::optional<bool> is_right_hand(const Skeleton& skeleton);

// The hinges of a hand's finger bones, fingers that curl by the plane in which they do, straight ones across the palm.
// Fingers keep their spread.
std::vector<std::pair<int, AnatomicalHinge>> finger_hinges(const Armature& armature, const Skeleton& skeleton,
                                                           BodySide side, bool right);

}  // namespace limber
