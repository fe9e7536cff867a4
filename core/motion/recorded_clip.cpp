// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/recorded_clip.h"

#include "core/motion/motion_edit.h"

namespace limber {

namespace {

Clip recorded(const Clip& source, Motion motion, int start) {
  Clip clip = clip_of(std::make_shared<const Motion>(std::move(motion)), source.name, start);
  clip.rate = source.rate;
  clip.markers = source.markers;
  // The body travels as in the motion, since the motion's skeleton is the rig's own.
  clip.retarget.travel = Travel::Free;
  return clip;
}

}  // namespace

Clip clip_of_poses(const Clip& source, const Armature& armature, const std::vector<Pose>& poses, int start) {
  return recorded(
      source,
      motion_of_poses(armature, static_cast<int>(poses.size()), source.rate, [&](int frame) { return poses[frame]; }),
      start);
}

Clip baked_clip(const std::shared_ptr<const Clip>& clip, const std::shared_ptr<const Armature>& armature,
                Progress& progress) {
  return recorded(*clip, played_motion(clip, armature, progress), clip->range_start);
}

}  // namespace limber
