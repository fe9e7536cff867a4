// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the clinical angles (joint_angles.h) of every joint in a pose, and changes one of them: the inverse of
// with_joint_angles() (anatomical_pose.h). Angles are measured from the anatomical position that body_frames() finds in
// the rig's bones, so the rest pose of a body that was scanned with bent elbows reads how far they are bent. They do
// not depend on where the body lies, on its size, or on the rolls of its bones.
//
// Reading and setting are inverse to each other, except in these cases:
//   - At a gimbal lock (joint_turns.h) two angles are one motion. The pose is kept, the angles may be others.
//   - A joint that is a hinge in the rig's limits has one angle, the flexion about its own axis, while its bone turns
//     about this axis only. A bone turned across it is read by all its angles.
//   - Spine and neck share their angles evenly between their bones; a pose that shares them otherwise is evened out.
//   - Turns that no angle names are left out: of a finger about its length, of a forearm in other shares than rigs
//   take.
#pragma once

#include <optional>
#include <vector>

#include "core/pose/anatomical_pose.h"

namespace limber {

// Returns the joints of the rig whose bones are known by their names, in the order of BodyJoint: left, right, middle.
std::vector<SidedJoint> joints_known_by_name(const BodyFrames& frames);

// Returns the angles, degrees, of every joint of the rig in a pose. Angles that a joint of this rig does not have are
// empty.
JointAngles clinical_angles(const Armature& armature, const BodyFrames& frames, const Pose& pose);
// Returns the angles of one joint; all empty if the rig does not have it.
JointMotions angles_of_joint(const Armature& armature, const BodyFrames& frames, const Pose& pose,
                             const SidedJoint& joint);

// Returns `pose` with one angle of one joint changed. The joint's other angles stay. A shoulder moves its collarbone by
// the shoulder rhythm on top of what the collarbone has.
//   motion   index into JointMotions
Pose with_clinical_angle(const Armature& armature, const BodyFrames& frames, const Pose& pose, const SidedJoint& joint,
                         std::size_t motion, double degrees);

// The fingers of a hand as a whole, degrees: the mean flexion of the knuckles and middle joints of its four fingers,
// and the mean spread of all but the middle finger. Empty if no finger of the hand is known by its name.
struct HandShape {
  std::optional<double> curl, spread;
};
HandShape hand_shape(const JointAngles& angles, BodySide side);

// Returns the range of a motion, degrees: that of the rig's limits if the joint is a hinge, else the range that adults
// usually reach (usual_range()).
AngleRange range_of_motion(const Armature& armature, const BodyFrames& frames, const SidedJoint& joint,
                           std::size_t motion);

// Returns the joints that a bone takes part in, in the order of BodyJoint: a forearm bone turns in elbow and forearm, a
// hand bone in forearm and wrist.
std::vector<SidedJoint> joints_of_bone(const BodyFrames& frames, int bone);

}  // namespace limber
