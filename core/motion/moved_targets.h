// SPDX-License-Identifier: AGPL-3.0-or-later
// Tells which constraints a change of the rig has moved the targets of. The place of a target is fixed to a bone as it
// is in the rest pose: where that bone gets another head or tail, the place is no longer where the user put it on it.
#pragma once

#include <string>
#include <vector>

#include "core/motion/constraint.h"
#include "core/rig/armature.h"

namespace limber {

// Returns the names of the constraints that need a place, whose target bone has another head or tail in the new rig.
//   from  for each bone of the new rig, its index in the old rig; -1: a new bone
std::vector<std::string> moved_targets(const Constraints& constraints, const Armature& before, const Armature& after,
                                       const std::vector<int>& from);

}  // namespace limber
