// SPDX-License-Identifier: AGPL-3.0-or-later
// The rotation of a joint as a function of its clinical angles (joint_angles.h), its exact inverse, and the bones that
// a joint turns. Rotations are those of a left joint, from the anatomical position, in the body's axes: x to the left,
// y to the back, z up. They are products of Cardan rotations, each about an axis that the earlier rotations carry
// along:
//   hip, shoulder   X(-flexion) Y(-abduction) Z(-internal rotation)  [Grood & Suntay 1983; Wu et al. 2002]
//   knee            X(flexion) Y(varus) Z(-internal rotation)
//   ankle           X(-dorsiflexion) Y(inversion) Z(-internal rotation)
//   elbow, forearm  X(-flexion) Y(-valgus) Z(-pronation of the forearm bone)  [Wu et al. 2005]
//   wrist           Z(-pronation of the hand bone) X(-flexion) Y(ulnar deviation)
//   spine, neck     X(flexion) Y(-right bending) Z(left rotation)
//   girdle          Z(-protraction) Y(-elevation) N(-upward rotation), N: perpendicular to the shoulder blade
// Each of these has a gimbal lock where its second rotation is 90 degrees (the abduction of a shoulder or hip, the
// flexion of a wrist): there the first and the third rotation have the same axis. The inverse then returns zero for the
// first angle. Elsewhere two sets of angles give the same rotation. The inverse returns the set that exceeds the usual
// ranges less, so an arm raised sideways has 160 degrees of abduction.
#pragma once

#include <optional>
#include <vector>

#include <glm/gtc/quaternion.hpp>

#include "core/pose/anatomical_frames.h"
#include "core/pose/joint_angles.h"

namespace limber {

// All joints, in the order of BodyJoint.
inline constexpr std::array kAllJoints = {BodyJoint::Spine, BodyJoint::Neck,    BodyJoint::Girdle, BodyJoint::Shoulder,
                                          BodyJoint::Elbow, BodyJoint::Forearm, BodyJoint::Wrist,  BodyJoint::Hip,
                                          BodyJoint::Knee,  BodyJoint::Ankle,   BodyJoint::Toes,   BodyJoint::Thumb,
                                          BodyJoint::Index, BodyJoint::Middle,  BodyJoint::Ring,   BodyJoint::Little};

// Returns the rotation of a joint with these angles; angles that are not given count as zero. Returns the identity for
// forearms and fingers, whose angles are applied elsewhere.
glm::dquat joint_turn(BodyJoint joint, const JointMotions& motions);

// Returns the angles for which joint_turn() gives this rotation. The angles of a forearm are empty.
//   turn  rotation of the bone below the joint relative to the bone above it. Pronation, which is the last factor of an
//         elbow's rotation and the first factor of a wrist's, is ignored.
JointMotions joint_motions_of(BodyJoint joint, const glm::dquat& turn);

// Return the angle of pronation about z, radians, in the rotation of a forearm bone (its last factor) and of a hand
// bone (its first factor).
double pronation_in_forearm(const glm::dquat& turn);
double pronation_in_hand(const glm::dquat& turn);

// Returns the Cardan angles x, y, z, radians: rotation = X(x) Y(y) Z(z). At a gimbal lock x is 0.
glm::dvec3 cardan_xyz(const glm::dquat& rotation);

// Returns true if the second rotation of a joint is so near to 90 degrees that its first and third rotation have the
// same axis.
bool at_gimbal_lock(BodyJoint joint, const JointMotions& motions);

// Returns the angle, degrees, between an arm with these shoulder angles and an arm that hangs down.
double raise_of_arm(const JointMotions& shoulder);
// Returns the upward rotation, degrees, that a raised arm adds to the collarbone [Inman, Saunders & Abbott 1944].
//   raise  angle of the arm, degrees, from raise_of_arm()
double shoulder_rhythm(double raise);

// Returns the bones that a joint turns, from the trunk outwards. Empty if the rig does not have the joint.
std::vector<int> bones_turned_by(const BodyFrames& frames, const SidedJoint& joint);
// Returns the hand bone that shares the forearm's pronation. Empty if there is no hand bone or if it is the rig's root.
std::optional<int> pronating_hand(const BodyFrames& frames, BodySide side);
bool has_joint(const BodyFrames& frames, const SidedJoint& joint);

// Returns the bone relative to which the angles of a joint are measured, -1: the world. For a shoulder this is the
// parent of the collarbone, for any other joint the parent of `bone`.
int reference_bone(const Armature& armature, const BodyFrames& frames, int bone, BodyJoint joint);

// Converts a bone's rotation from the rest pose into its rotation from the anatomical position, in world axes.
//   bone  -1: the world, which does not turn
glm::dquat turn_from_anatomical(const BodyFrames& frames, int bone, const glm::dquat& turn_from_rest);

// Convert rotations between the world's axes and the axes of a left joint. The rotations of right joints are mirrored.
glm::dquat turn_in_world(const BodyFrames& frames, BodySide side, const glm::dquat& turn);
glm::dquat turn_in_body(const BodyFrames& frames, BodySide side, const glm::dquat& turn);

}  // namespace limber
