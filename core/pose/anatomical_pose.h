// SPDX-License-Identifier: AGPL-3.0-or-later
// A pose by the angles of a body's joints, on any rig whose bones are recognised. A joint that is named stands at the
// angles that are said, from the anatomical position and whatever the rig's rest, its other motions at zero; joints
// that are not named keep what the pose has. What hangs from a named joint goes with it.
//
// Hips and shoulders turn by flexion about the body's left-right axis, then abduction about the axis that this has
// carried along, then rotation about the limb [Grood & Suntay 1983]; shoulders count from the trunk, not from the
// collarbone. A raised arm takes the collarbone and the shoulder blade along, unless the shoulder girdle is named too.
// Spine and neck share their turn evenly among their bones. A forearm's pronation is shared by forearm and hand. The
// body as a whole neither turns nor moves.
#pragma once

#include <string>
#include <vector>

#include "core/pose/anatomical_frames.h"
#include "core/pose/joint_angles.h"
#include "core/rig/pose.h"

namespace limber {

//   angles  of joints that the rig has; others are passed over
Pose with_joint_angles(const Armature& armature, const BodyFrames& frames, const Pose& pose, const JointAngles& angles);

// The joints with the side that the rig has them on, where none was said; fingers that are one bone bend as the middle
// one. throws Error for a joint that the rig lacks or whose side must be said; `where` names the request
JointAngles with_sides(const BodyFrames& frames, const JointAngles& angles, const std::string& where);

// The joints of `angles` that the rig has, with their sides: what a pose for any body is on this one.
JointAngles known_to_rig(const BodyFrames& frames, const JointAngles& angles);

// The joints of `angles` that the rig lacks between others that it has, by name: "left hip, right hip". A limb that
// begins or ends further out lacks nothing.
std::string lacking_within_limbs(const BodyFrames& frames, const JointAngles& angles);

// A line that names limbs' bones that do not hang from the bone above them, and so do not go with it; empty where all
// do.
std::string limbs_apart(const Armature& armature, const BodyFrames& frames);

// The bones that the joints of `angles` turn.
std::vector<int> bones_of_joints(const BodyFrames& frames, const JointAngles& angles);

// The names of the joints that a rig has: "left hip, right hip, neck"; empty where no bone is recognised.
std::string joints_of_rig(const BodyFrames& frames);

// One line that lists the bones that a pose turns beyond the rig's own limits; empty where there is none.
std::string beyond_limits(const Armature& armature, const Pose& pose);

}  // namespace limber
