// SPDX-License-Identifier: AGPL-3.0-or-later
// Interpolates the way from rest to a pose for solvers that move along it in steps. At t every joint has turned by the
// share t of its rotation about the same axis, and the translations of the root and of gliding joints are scaled by t.
#pragma once

#include <string>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

// Returns the pose at the share t of the way from rest to `pose`.
//   t        [0, 1]; exactly rest at 0 and exactly `pose` at 1
Pose part_of_pose(const Pose& pose, double t);

// Returns the pose at the share t of the way from one pose to another; every joint turns the shorter way.
Pose pose_between(const Pose& from, const Pose& to, double t);

// Returns the posed_from_rest motions of the named bones, in the order of the names.
//   throws Error when the rig lacks one of them
std::vector<RigidTransform> bone_motions(const std::vector<std::string>& bones, const Armature& armature,
                                         const Pose& pose);

// Return the largest rotation of any joint from rest, or from another pose, in degrees [0, 180].
double largest_angle_degrees(const Pose& pose);
double largest_angle_degrees(const Pose& from, const Pose& to);

}  // namespace limber
