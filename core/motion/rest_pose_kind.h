// SPDX-License-Identifier: AGPL-3.0-or-later
// What a rest pose stands for, said by its name where the joints do not tell. Rotations of a take count from how the
// actor stood at zero; exporters write that moment with joints along any axis, and few skeletons have the fingers that
// tell where a palm faces. A name says both, as the T-pose does to which characters are laid before motion is carried
// over.
//   T-pose       arms to the sides, palms down
//   A-pose       arms half way down, thumbs forward
//   anatomical   arms hanging, palms forward; a body on its back lies so too
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

const char* word_of(RestStance stance);  // of files and the command line: "file", "T", "A", "anatomical"
// Any case; "supine" is anatomical too. Throws Error for what is none.
RestStance stance_of_word(const std::string& word, const std::string& where);

// Unit, in the body's axes: left, back, up. Nothing where the stance does not say.
std::optional<glm::dvec3> direction_in(RestStance stance, const JointRole& role);
// Across the palm from the index to the little finger, of a hand that points along `hand`; likewise.
std::optional<glm::dvec3> palm_in(RestStance stance, BodySide side, const glm::dvec3& hand);

// The body's axes, upright where its joints do not tell.
glm::dmat3 axes_of_body(const Skeleton& skeleton);

// Limbs that lie more than 30 degrees off the stance are turned into it, with what hangs from them: only OFFSETs
// change. What is nearer is right as it is, since no T-pose is perfect.
//   frame  at which the motion stands so; -1: its rest
struct Straightened {
  Motion motion;
  std::vector<int> turned;  // joints
};
Straightened straightened(const Motion& motion, RestStance stance, int frame);

}  // namespace limber
