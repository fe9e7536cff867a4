// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/played_motion.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/motion/motion_edit.h"

namespace limber {

Motion played_motion(const std::shared_ptr<const Clip>& clip, const std::shared_ptr<const Armature>& armature,
                     Progress& progress) {
  const ClipOnRig on_rig(clip, armature);
  if (!on_rig.problem().empty())
    throw Error("the clip \"" + clip->name + "\" does not move this rig: " + on_rig.problem(), "motion",
                "match the clip's joints, or delete the clip");
  const int frames = std::max(0, clip->range_end - clip->range_start) + 1;
  return motion_of_poses(*armature, frames, clip->rate, [&](int frame) {
    progress.update("frames", double(frame) / frames);
    return on_rig.at(clip->range_start + frame);
  });
}

}  // namespace limber
