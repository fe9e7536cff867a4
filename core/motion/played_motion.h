// SPDX-License-Identifier: AGPL-3.0-or-later
// Records a clip frame by frame as it plays on a rig, including its keys, curves and retargeting.
#pragma once

#include "core/base/progress.h"
#include "core/motion/clip.h"

namespace limber {

// Records the rig's poses at the frames range_start to range_end of the clip. Throws Error if the clip has a motion
// that cannot move the rig, and Cancelled.
Motion played_motion(const std::shared_ptr<const Clip>& clip, const std::shared_ptr<const Armature>& armature,
                     Progress& progress = no_progress());

}  // namespace limber
