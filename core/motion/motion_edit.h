// SPDX-License-Identifier: AGPL-3.0-or-later
// Motions made of motions.
#pragma once

#include <array>
#include <functional>

#include "core/motion/bvh.h"
#include "core/rig/pose.h"

namespace limber {

// The three axes (0 to 2) that a joint's rotation channels turn about, in their order; nothing where it has fewer, or
// one twice.
std::optional<std::array<int, 3>> euler_order(const BvhJoint& joint);

// Angles a, b, c in radians with rotation = R_i(a) R_j(b) R_k(c) for the axes i, j, k of `order` [Shoemake, Graphics
// Gems IV, 1994]. Of the two that there are, the one nearest to `near`, whole turns included, so that curves do not
// jump. Where the middle one is a right angle, c is that of `near`.
glm::dvec3 euler_angles(const glm::dquat& rotation, const std::array<int, 3>& order,
                        const glm::dvec3& near = glm::dvec3(0));

// A file whose z axis is up, in axes whose y axis is: (x, y, z) becomes (x, z, -y).
Motion y_up_from_z_up(const Motion& motion);

// The same course at another number of frames in a second: rotations by slerp between the frames on either side,
// positions along the line. The first frame stays the first, and the last moment is kept to within a frame. Rotations
// of joints with fewer than three channels are mixed channel by channel.
//   rate  [0.1, 1000]; throws Error outside, or when more than 10 million frames would come of it
Motion resampled(const Motion& motion, double rate);

// A motion of the rig: a joint for each bone, whose frames say where it goes.
//   pose_at  called once for each of the frames [0, frames)
Motion motion_of_poses(const Armature& armature, int frames, double rate, const std::function<Pose(int)>& pose_at);

}  // namespace limber
