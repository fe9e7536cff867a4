// SPDX-License-Identifier: AGPL-3.0-or-later
// Mirrors a whole clip: in every frame the left side of the rig moves as the right side did, and the body's travel is
// mirrored too.
#pragma once

#include "core/motion/clip.h"

namespace limber {

// Returns the clip that plays flipped(pose) (core/rig/mirror.h) wherever the clip plays `pose` on this rig. The motion
// stays as it is and is carried over mirrored; keys, their handles and the body's shift are mirrored. Twice gives the
// first clip back. A clamped key of the shift is clamped axis by axis, so where the mirror plane stands askew to the
// axes its handles become aligned, with the speeds that they had.
Clip mirrored_clip(const std::shared_ptr<const Clip>& clip, const std::shared_ptr<const Armature>& armature);

}  // namespace limber
