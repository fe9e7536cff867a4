// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a pose the rest pose of its rig: the bones stay where the pose has moved them.
#pragma once

#include "core/rig/pose.h"

namespace limber {

// Returns the rig with the pose as its rest pose. A hinge can still reach the same positions; if the pose was beyond
// the hinge's limits, they are widened to contain it. The cone and twist limits of a ball joint keep their size around
// the new rest pose.
Armature with_pose_as_rest(const Armature& armature, const Pose& pose);

}  // namespace limber
