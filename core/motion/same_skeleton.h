// SPDX-License-Identifier: AGPL-3.0-or-later
// Recognizes a motion of the rig itself: the motion was written for this rig, or the rig was made from the motion's
// hierarchy. Then each joint drives the bone of its name, without matching and without rest offsets.
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
  bool in_place = false;  // the transform is the identity
};

// Returns the similarity if every bone has a joint of the same name under its parent's joint, and all positions agree
// to a thousandth of the rig's size; else nothing.
std::optional<SameSkeleton> same_skeleton(const Motion& motion, const Armature& armature);

}  // namespace limber
