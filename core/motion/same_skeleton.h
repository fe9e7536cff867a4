// SPDX-License-Identifier: AGPL-3.0-or-later
// Recognizes a motion whose skeleton is the rig's own: the motion was written for this rig, or the rig was made from
// the motion's hierarchy. Each joint then moves the bone of the same name, and no limb needs a correction of its own.
#pragma once

#include <optional>

#include "core/motion/bvh.h"
#include "core/rig/armature.h"

namespace limber {

// The similarity transform from the source's joints at rest to those of the rig, in LPS:
//   rig = scale * rig_from_source * source + shift
struct SameSkeleton {
  glm::dquat rig_from_source{1, 0, 0, 0};
  double scale = 1;       // mm per unit of the file
  bool in_place = false;  // true: the transform is the identity, within 0.01 mm
};

// Returns the similarity transform if the skeletons are the same: every bone has a joint of the same name, whose parent
// has the name of the bone's parent, and all positions agree to a thousandth of the rig's size. Else returns nothing.
std::optional<SameSkeleton> same_skeleton(const Motion& motion, const Armature& armature);

}  // namespace limber
