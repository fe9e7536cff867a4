// SPDX-License-Identifier: AGPL-3.0-or-later
// Which axis of a BVH file points up. The format does not say: most files have y up, those of Blender and of many
// capture systems z. A body tells by itself: its head is above its feet, or its neck above its hips. What the frames
// show counts before the rest pose, since a skeleton that rests along z may be turned upright by its root in every
// frame. Where names say nothing, a take that travels does so along the ground.
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

// Y where nothing tells.
UpGuess up_axis_of(const Motion& motion);

// Half a sentence: "its head is above its feet along z over the frames"; empty where nothing told.
std::string reason_of(const UpGuess& guess);

}  // namespace limber
