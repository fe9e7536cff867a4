// SPDX-License-Identifier: AGPL-3.0-or-later
// A motion of the rig itself: one that was written for it, or of whose hierarchy it was made. Its joints need no
// matching and no offsets; each is its bone.
#pragma once

#include <optional>

#include "core/motion/bvh.h"
#include "core/rig/armature.h"

namespace limber {

// rig = scale * rig_from_source * source + shift, of joints at rest in LPS.
struct SameSkeleton {
  glm::dquat rig_from_source{1, 0, 0, 0};
  double scale = 1;       // mm for a unit of the file
  bool in_place = false;  // nothing but the identity is between them
};

// Where every bone has a joint of its name under that of its parent, and all lie alike to a thousandth of the rig's
// size.
std::optional<SameSkeleton> same_skeleton(const Motion& motion, const Armature& armature);

}  // namespace limber
