// SPDX-License-Identifier: AGPL-3.0-or-later
// The kinds of rest pose (stances) that a user can name if a motion file does not show its rest pose. The rotations of
// a motion are relative to the actor's pose with all angles zero. In many files the joints of this pose do not lie as
// the actor's did, and few skeletons have the fingers that show where a palm faces. The named stance gives the
// directions of the limbs and of the palms:
//   T-pose       arms to the sides, palms down
//   A-pose       arms half way down, thumbs forward
//   anatomical   arms hanging, palms forward; also a body that lies on its back
// In all of them legs and trunk are straight and feet point forward.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/motion/body_frame.h"

namespace limber {

enum class RestStance : std::uint8_t { AsItLies, TPose, APose, Anatomical };
constexpr RestStance kRestStances[] = {RestStance::AsItLies, RestStance::TPose, RestStance::APose,
                                       RestStance::Anatomical};

// Returns the word for a stance in files and on the command line: "file", "T", "A" or "anatomical".
const char* word_of(RestStance stance);
// Returns the stance that a word names ("T", "A", "anatomical", "file"), in upper or lower case. "supine" also names
// the anatomical stance. Throws Error for any other word.
//   where  names the source of the word in the error message
RestStance stance_of_word(const std::string& word, const std::string& where);

// Returns the unit direction of a body part in this stance, in the body's axes (left, back, up). Returns nothing where
// the stance does not define the direction.
std::optional<glm::dvec3> direction_in(RestStance stance, const JointRole& role);
// Returns the unit direction across the palm, from the index to the little finger, in the body's axes. Returns nothing
// if the stance or the side does not define this direction.
//   hand  the direction in which the hand points, in the body's axes
std::optional<glm::dvec3> palm_in(RestStance stance, BodySide side, const glm::dvec3& hand);

// Returns the body's axes (left, back, up), computed from its hips or its shoulders. Returns the world's axes for a
// skeleton that has neither.
glm::dmat3 axes_of_body(const Skeleton& skeleton);

// A motion whose skeleton was brought into a stance: each limb more than 30 degrees off the stance (feet: 60) was
// turned into it, together with its descendants. Only OFFSETs (positions of joints relative to their parents) change.
// Limbs nearer to the stance stay as they are, since no T-pose is perfect.
struct Straightened {
  Motion motion;
  std::vector<int> turned;  // indices of the joints that were turned
};
// Brings the motion's skeleton into the stance.
//   frame  the frame at which the actor was in this stance; -1: the rest pose
Straightened straightened(const Motion& motion, RestStance stance, int frame);

}  // namespace limber
