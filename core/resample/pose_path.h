// SPDX-License-Identifier: AGPL-3.0-or-later
// Interpolates between rest and a pose, for solvers that move to the pose in steps. At a share t of the way every joint
// has turned by t times its angle about its axis, and the translations of the root and of gliding joints are scaled by
// t.
#pragma once

#include <string>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

// Returns the pose at the share t of the way from rest to `pose`.
//   t  [0, 1]; the result is exactly rest for 0 and exactly `pose` for 1
Pose part_of_pose(const Pose& pose, double t);

// Returns the pose at the share t, [0, 1], of the way from one pose to another; every joint turns in the direction of
// the smaller angle.
Pose pose_between(const Pose& from, const Pose& to, double t);

// Returns the posed_from_rest motions of the named bones, in the order of the names.
//   throws Error when the rig lacks one of them
std::vector<RigidTransform> bone_motions(const std::vector<std::string>& bones, const Armature& armature,
                                         const Pose& pose);

// Return the largest angle in degrees, [0, 180], by which any joint is turned in a pose, or between two poses.
double largest_angle_degrees(const Pose& pose);
double largest_angle_degrees(const Pose& from, const Pose& to);

}  // namespace limber
