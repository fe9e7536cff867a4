// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes clips of poses: the motion of such a clip is a recording of the rig itself, and it has no keys.
#pragma once

#include "core/motion/clip.h"
#include "core/motion/played_motion.h"

namespace limber {

// Returns a clip that plays the poses as they are from frame `start` on, with the name, rate and markers of `source`.
// Rotations are kept to 1e-6 radians, as a BVH's numbers are.
Clip clip_of_poses(const Clip& source, const Armature& armature, const std::vector<Pose>& poses, int start);

// Returns the clip with its keys and curves, and the retargeting, made part of the motion, for the frames range_start
// to range_end. Throws Error and Cancelled as played_motion() does.
Clip baked_clip(const std::shared_ptr<const Clip>& clip, const std::shared_ptr<const Armature>& armature,
                Progress& progress = no_progress());

}  // namespace limber
