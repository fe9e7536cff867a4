// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws a small picture of a posed rig as a jointed doll: a cylinder with round ends along each bone, about as thick as
// that part of a human body. Needs neither a volume nor a graphics card.
#pragma once

#include "core/rig/pose.h"
#include "render/image_io.h"

namespace limber::editor {

// Returns the picture. The rig is seen from the front and a little from its left, in parallel projection, on a
// transparent background.
//   size  width and height of the picture, pixels
render::Image body_picture(const Armature& armature, const Pose& pose, const glm::ivec2& size);

}  // namespace limber::editor
