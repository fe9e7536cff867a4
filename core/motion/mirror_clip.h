// SPDX-License-Identifier: AGPL-3.0-or-later
// Mirrors a whole clip: in every frame the left side of the rig moves as the right side did, and the body's travel is
// mirrored too.
#pragma once

#include "core/motion/clip.h"

namespace limber {

// Returns the clip that plays flipped(pose) (core/rig/mirror.h) wherever the clip plays `pose` on this rig. The clip
// keeps its motion, and the retargeting swaps left and right; keys, their handles and the body's shift are mirrored.
// Mirroring twice gives the original clip. A clamped key of the shift is clamped axis by axis. If the mirror plane is
// not perpendicular to an axis, this clamping would differ after mirroring, so such handles become aligned, with the
// tangents that they had.
Clip mirrored_clip(const std::shared_ptr<const Clip>& clip, const std::shared_ptr<const Armature>& armature);

}  // namespace limber
