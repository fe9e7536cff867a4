// SPDX-License-Identifier: AGPL-3.0-or-later
// Poses a rig by the angles of a body's joints, such as the flexion of the left knee. Works on any rig whose bones are
// recognised by their names. Angles are measured from the anatomical position, whatever the rig's rest pose is. A
// request that names a joint sets all motions of this joint; those without an angle become zero (in fingers they stay).
// Other joints keep their rotation. Bones below a joint move with it.
//
// Hips and shoulders turn by flexion about the body's left-right axis, then by abduction about the axis that the
// flexion has carried along, then by rotation about the limb [Grood & Suntay 1983]. Shoulder angles are relative to the
// trunk, not to the collarbone. A raised arm also moves the collarbone and the shoulder blade, unless the request sets
// the shoulder girdle. The bones of the spine share its rotation evenly, and so do the bones of the neck. Forearm and
// hand share a pronation. The body as a whole neither turns nor moves.
#pragma once

#include <string>
#include <vector>

#include "core/pose/anatomical_frames.h"
#include "core/pose/joint_angles.h"
#include "core/rig/pose.h"

namespace limber {

// Returns `pose` with the joints at the given angles.
//   angles  joints that the rig does not have are ignored
Pose with_joint_angles(const Armature& armature, const BodyFrames& frames, const Pose& pose, const JointAngles& angles);

// Adds a side to each joint that has none: the only side on which the rig has the joint. If several joints are
// requested, those that the rig does not have are left out. Throws Error if the rig has none of the requested joints,
// or has a joint on both sides and no side was given.
//   where  names the request in messages
JointAngles with_sides(const BodyFrames& frames, const JointAngles& angles, const std::string& where);

// Returns those joints of `angles` that the rig has, with their sides. This fits a pose for any body to the rig.
JointAngles known_to_rig(const BodyFrames& frames, const JointAngles& angles);

// Returns the names of the joints of `angles` that the rig lacks although it has the next joint of the same limb: "left
// hip, right hip". A joint that is missing at the end of a limb is not listed.
std::string lacking_within_limbs(const BodyFrames& frames, const JointAngles& angles);

// Returns a warning that lists limb bones that are not descendants of the bone above them. Such a bone stays behind
// when the bone above it moves. Returns an empty text if there are none.
std::string limbs_apart(const Armature& armature, const BodyFrames& frames);

// Returns the bones that the joints of `angles` turn.
std::vector<int> bones_of_joints(const BodyFrames& frames, const JointAngles& angles);

// Returns the names of the joints that a rig has: "left hip, right hip, neck"; empty where no bone is recognised.
std::string joints_of_rig(const BodyFrames& frames);

// Returns a warning that lists the bones that a pose turns beyond the rig's joint limits. The text is empty if there
// are no such bones.
std::string beyond_limits(const Armature& armature, const Pose& pose);

}  // namespace limber
