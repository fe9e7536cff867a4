// SPDX-License-Identifier: AGPL-3.0-or-later
// Bakes constraints into keys.
#pragma once

#include "core/base/progress.h"
#include "core/motion/clip.h"

namespace limber {

// Returns the clip without constraints, in which the bones that they turned have a key in each of the frames first to
// last. It plays there as before, bit for bit. A bone that no constraint turns keeps its keys. Constraints that are
// switched off, or cannot be applied, go without a trace. Throws Error if the clip has no constraints, or a motion that
// cannot move the rig, and Cancelled.
Clip with_constraints_as_keys(const std::shared_ptr<const Clip>& clip, const std::shared_ptr<const Armature>& armature,
                              int first, int last, Progress& progress);

}  // namespace limber
