// SPDX-License-Identifier: AGPL-3.0-or-later
// A body and an actor of other proportions, both checkable by hand.
#pragma once

#include <array>
#include <vector>

#include "core/motion/bvh.h"
#include "core/rig/armature.h"

namespace limber::test {

// A rig of a body with hanging arms, mm, LPS.
Armature hanging_body();
// A motion of a body in T-pose, two units to the metre less, whose joints all turn as the angles say (degrees about x,
// y, z).
Motion t_pose_body(const std::vector<std::array<double, 3>>& frames);

}  // namespace limber::test
