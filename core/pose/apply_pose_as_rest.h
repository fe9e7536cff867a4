// SPDX-License-Identifier: AGPL-3.0-or-later
// A pose becomes the rest of its rig: the bones stay where the pose has them and are at rest there.
#pragma once

#include "core/rig/pose.h"

namespace limber {

// Joints go on allowing what they allowed. A hinge's range is counted from its new rest, and holds it also where the
// pose went beyond the old range; a ball's cone and twist are about the new rest.
Armature with_pose_as_rest(const Armature& armature, const Pose& pose);

}  // namespace limber
