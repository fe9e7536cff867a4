// SPDX-License-Identifier: AGPL-3.0-or-later
// A small picture of a rig in a pose as a jointed doll: a rounded solid along each bone, as thick as that part of a
// body is. It needs neither a body nor a graphics card.
#pragma once

#include "core/rig/pose.h"
#include "render/image_io.h"

namespace limber::editor {

// From the body's front and a little from its left, without perspective, on a transparent ground.
//   size  pixels
render::Image body_picture(const Armature& armature, const Pose& pose, const glm::ivec2& size);

}  // namespace limber::editor
