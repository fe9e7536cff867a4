// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the angles that the joints of a rig have in its rest pose, from the directions of the bones. The angles are
// relative to the anatomical position, from which usual ranges of motion are measured [AAOS, Joint Motion: Method of
// Measuring and Recording, 1965: the neutral zero method]. A rig's limits, in contrast, are relative to its rest pose:
// a body that was scanned with a bent elbow may rest at 60 degrees of flexion. In the anatomical position, the bone
// below a
//    hinge              is in line with its parent, seen along the hinge's axis: the limb is straight
//    shoulder, hip      is in line with the trunk, and points down
//    wrist, neck, head  is in line with its parent
//    ankle              is at a right angle to the shank
// Toes, feet, necks and heads are oblique even in a body that stands straight; for them, up to 30 degrees count as
// straight. Angles are in radians, axes in world coordinates in the rest pose.
#pragma once

#include <optional>
#include <vector>

#include "core/rig/armature.h"
#include "core/rig/joint_names.h"

namespace limber {

// Returns the anatomical role (body part, side, number) of each bone of an armature, found from the bones' names.
std::vector<std::optional<JointRole>> roles_of(const Armature& armature);

// Returns the rest angle of a hinge about a unit axis, -pi .. pi; 0 is straight. Returns nothing if the bone has no
// parent, if bone and parent are never in line in a body, or if one of them is nearly parallel to the axis, so that the
// angle is undetermined.
std::optional<double> told_hinge_angle(const Armature& armature, int bone, const glm::dvec3& axis);
// Returns the rest angle of a hinge from told_hinge_angle(), or 0 if that function returns nothing.
double hinge_angle_at_rest(const Armature& armature, int bone, const glm::dvec3& axis);

// Returns the swing of a ball joint from its anatomical position to the rest pose, as a rotation vector. Returns zero
// if the body part has no anatomical position, or if bones that define this position are missing (a shoulder needs a
// spine).
glm::dvec3 ball_swing_at_rest(const Armature& armature, int bone, BodyPart part);

// Returns the rest angle of a hinge or the rest swing of a ball joint, as a rotation vector from the anatomical
// position. The type of the bone's limits decides which. Added to the rotation vector of a rotation from rest, it gives
// the anatomical angles.
glm::dvec3 turn_at_rest(const Armature& armature, int bone);

}  // namespace limber
