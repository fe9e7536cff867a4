// SPDX-License-Identifier: AGPL-3.0-or-later
// The way from rest to a pose, for what must go there in steps: at t every joint has turned by the share t of its
// rotation, about the same axis, and the root has gone the share t of its way, as has every joint that glides.
#pragma once

#include <string>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

//   t        [0, 1]; exactly rest at 0 and exactly `pose` at 1
Pose part_of_pose(const Pose& pose, double t);

// The same from one pose to another: every joint turns the shorter way.
Pose pose_between(const Pose& from, const Pose& to, double t);

// posed_from_rest of the named bones, in their order.    throws Error when the rig has no such bone
std::vector<RigidTransform> bone_motions(const std::vector<std::string>& bones, const Armature& armature,
                                         const Pose& pose);

// Of the joint that turns furthest from rest, or from another pose, degrees [0, 180].
double largest_angle_degrees(const Pose& pose);
double largest_angle_degrees(const Pose& from, const Pose& to);

}  // namespace limber
