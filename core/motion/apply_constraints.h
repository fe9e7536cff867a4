// SPDX-License-Identifier: AGPL-3.0-or-later
// Replaces the constraints of a clip by keys that give the same poses.
#pragma once

#include "core/base/progress.h"
#include "core/motion/clip.h"

namespace limber {

// Returns the clip without constraints. Each bone that a constraint turned has a key in every frame from `first` to
// `last`; in these frames the clip plays as before, bit for bit. A bone that no constraint turns keeps its keys.
// Constraints that are switched off, or cannot be applied, are dropped. Throws Error if the clip has no constraints, or
// if its motion cannot move the rig. Throws Cancelled when the user stops it.
Clip with_constraints_as_keys(const std::shared_ptr<const Clip>& clip, const std::shared_ptr<const Armature>& armature,
                              int first, int last, Progress& progress);

}  // namespace limber
