// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the clinical angles (joint_angles.h) of every joint in a pose, and changes one of them: the inverse of
// with_joint_angles() (anatomical_pose.h). Angles are measured from the anatomical position that body_frames() finds in
// the rig's bones. The rest pose of a body that was scanned with bent elbows therefore has the angles of these elbows.
// The angles depend neither on the body's position, nor on its size, nor on the rolls of its bones.
//
// Computing and setting angles are inverse to each other, except in these cases:
//   - At a gimbal lock (joint_turns.h) two angles have one axis. The pose is kept, but the angles may differ.
//   - A joint that is a hinge in the rig's limits has one angle, the flexion about its own axis, as long as its bone
//     rotates about this axis only. Otherwise all angles of the joint are computed.
//   - Spine and neck share their angles evenly between their bones. A pose with other shares gets even ones.
//   - Rotations without a clinical name are lost, such as a rotation of a finger about its length.
#pragma once

#include <optional>
#include <vector>

#include "core/pose/anatomical_pose.h"

namespace limber {

// Returns the joints whose bones are recognised by their names, in the order of BodyJoint; for each joint the left one,
// the right one, then the one without a side.
std::vector<SidedJoint> joints_known_by_name(const BodyFrames& frames);

// Returns the angles, degrees, of every joint of the rig in a pose. Angles that a joint does not have are empty.
JointAngles clinical_angles(const Armature& armature, const BodyFrames& frames, const Pose& pose);
// Returns the angles of one joint; all are empty if the rig does not have the joint.
JointMotions angles_of_joint(const Armature& armature, const BodyFrames& frames, const Pose& pose,
                             const SidedJoint& joint);

// Returns `pose` with one angle of one joint changed. The joint's other angles stay. Raising a shoulder also rotates
// its collarbone by the shoulder rhythm, in addition to the collarbone's own rotation.
//   motion  index in JointMotions
Pose with_clinical_angle(const Armature& armature, const BodyFrames& frames, const Pose& pose, const SidedJoint& joint,
                         std::size_t motion, double degrees);

// The fingers of a hand as a whole, degrees: the mean flexion of the knuckles and middle joints of the four fingers,
// and the mean spread of all fingers but the middle one. Empty if no finger of the hand is recognised by its name.
struct HandShape {
  std::optional<double> curl, spread;
};
HandShape hand_shape(const JointAngles& angles, BodySide side);

// Returns the range of a motion, degrees. For a hinge, this is the range of the rig's limits; else the range that
// adults usually reach (usual_range()).
AngleRange range_of_motion(const Armature& armature, const BodyFrames& frames, const SidedJoint& joint,
                           std::size_t motion);

// Returns the joints that a bone's rotation belongs to, in the order of BodyJoint. A forearm bone belongs to elbow and
// forearm, a hand bone to forearm and wrist.
std::vector<SidedJoint> joints_of_bone(const BodyFrames& frames, int bone);

}  // namespace limber
