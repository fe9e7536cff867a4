// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes clips from poses. The motion of such a clip is a recording of the rig itself, and the clip has no keys.
#pragma once

#include "core/motion/clip.h"
#include "core/motion/played_motion.h"

namespace limber {

// Returns a clip that plays the given poses from frame `start` on, with the name, rate and markers of `source`.
// Rotations are exact to 1e-6 radians, as in a BVH file.
Clip clip_of_poses(const Clip& source, const Armature& armature, const std::vector<Pose>& poses, int start);

// Returns the clip with its keys, curves and retargeting baked into the motion, for the frames range_start to
// range_end. Throws Error and Cancelled as played_motion() does.
Clip baked_clip(const std::shared_ptr<const Clip>& clip, const std::shared_ptr<const Armature>& armature,
                Progress& progress = no_progress());

}  // namespace limber
