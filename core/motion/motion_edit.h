// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes new motions: a motion converted to another up axis, a motion resampled to another frame rate, or a recording of
// the poses of a rig.
#pragma once

#include <array>
#include <functional>

#include "core/base/progress.h"
#include "core/motion/bvh.h"
#include "core/rig/pose.h"

namespace limber {

// Returns the axes (0: x, 1: y, 2: z) of a joint's three rotation channels, in the channels' order. Returns nothing
// unless the joint rotates about each axis exactly once.
std::optional<std::array<int, 3>> euler_order(const BvhJoint& joint);

// Returns angles a, b, c in radians with rotation = R_i(a) R_j(b) R_k(c) for the axes i, j, k of `order` [Shoemake,
// Graphics Gems IV, 1994]. Of the two solutions it returns the one nearest to `near`, shifted by whole turns, so that
// curves do not jump. Where b is a right angle (gimbal lock), it takes c from `near`.
glm::dvec3 euler_angles(const glm::dquat& rotation, const std::array<int, 3>& order,
                        const glm::dvec3& near = glm::dvec3(0));

// Converts a motion whose z axis is up to one whose y axis is up: (x, y, z) becomes (x, z, -y).
Motion y_up_from_z_up(const Motion& motion);

// Resamples a motion to another frame rate: rotations by slerp between the frames on either side, positions linearly.
// The first frame stays, and the duration changes by less than a frame. A joint that does not rotate about three
// different axes is interpolated channel by channel. Throws Error for a rate outside of [0.1, 1000] and for a result of
// more than 10 million frames. Throws Cancelled when the user stops it.
//   rate  frames per second
Motion resampled(const Motion& motion, double rate, Progress& progress = no_progress());

// Records a motion of the rig: one joint for each bone, one frame for each pose.
//   pose_at  called once for each of the frames [0, frames)
Motion motion_of_poses(const Armature& armature, int frames, double rate, const std::function<Pose(int)>& pose_at);

}  // namespace limber
