// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the constraints whose target positions a change of the rig has moved. A target position is fixed to a bone in
// the rest pose. If this bone gets another head or tail, the position no longer lies where the user set it on the bone.
#pragma once

#include <string>
#include <vector>

#include "core/motion/constraint.h"
#include "core/rig/armature.h"

namespace limber {

// Returns the names of the constraints with a target position whose target bone has another head or tail in the new
// rig.
//   before, after  the old rig and the new rig
//   from           for each bone of the new rig, its index in the old rig; -1: a new bone
std::vector<std::string> moved_targets(const Constraints& constraints, const Armature& before, const Armature& after,
                                       const std::vector<int>& from);

}  // namespace limber
