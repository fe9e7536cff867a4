// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds which axis of a BVH file points up. The format does not say: most files have y up, those of Blender and of many
// capture systems have z up. The body decides: its head is above its feet, or its neck above its hips. The poses in the
// frames take precedence over the rest pose, since the root of a skeleton that rests along z may turn it upright in
// every frame. If the joint names are unknown, the direction of travel decides, since a body travels along the ground.
#pragma once

#include <string>

#include "core/motion/bvh.h"

namespace limber {

enum class UpAxis { Y, Z };

struct UpGuess {
  UpAxis axis = UpAxis::Y;
  enum class By { Nothing, Frames, Rest, Travel } by = By::Nothing;

  bool operator==(const UpGuess&) const = default;
};

// Guesses the up axis of a motion. Returns Y if neither poses nor travel show the axis.
UpGuess up_axis_of(const Motion& motion);

// Returns the reason for the guess as half a sentence ("over its frames the head is above the feet along z"), empty if
// there is none.
std::string reason_of(const UpGuess& guess);

}  // namespace limber
