// SPDX-License-Identifier: AGPL-3.0-or-later
// The rig of a body and the motion of an actor with other proportions, both simple enough to check by hand.
#pragma once

#include <array>
#include <vector>

#include "core/motion/bvh.h"
#include "core/rig/armature.h"

namespace limber::test {

// Returns the rig of a body with hanging arms, in mm, LPS.
Armature hanging_body();
// Returns the motion of an actor whose rest pose is the T-pose, with hips at a height of 9 units. In each frame, joint
// number j is turned by 1 + 0.1 j times the frame's three angles, degrees about z, x and y.
Motion t_pose_body(const std::vector<std::array<double, 3>>& frames);

}  // namespace limber::test
