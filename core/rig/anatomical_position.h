// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the angles of joints at rest, relative to the anatomical position, from the directions of the rig's bones.
// Usual ranges of motion are measured from the anatomical position [AAOS, Joint Motion: Method of Measuring and
// Recording, 1965: the neutral zero method], but a rig's limits are relative to rest: a body that was scanned with a
// bent elbow may have 60 degrees of flexion at rest. In the anatomical position, the bone that moves at a
//    hinge              is in line with its parent, seen along the hinge's axis: the limb is straight
//    shoulder, hip      is in line with the trunk, and points down
//    wrist, neck, head  is in line with its parent
//    ankle              is at a right angle to the shank
// Toes, feet, necks and heads are oblique in a body that stands straight; up to 30 degrees count as straight. Angles
// are in radians, axes in the world at rest.
#pragma once

#include <optional>
#include <vector>

#include "core/rig/armature.h"
#include "core/rig/joint_names.h"

namespace limber {

// Returns the anatomical roles of an armature's bones, from their names.
std::vector<std::optional<JointRole>> roles_of(const Armature& armature);

// Returns the angle of a hinge at rest about a unit axis, -pi .. pi; 0 is straight. Returns nothing if the bone has no
// parent, if the body has no straight position for it, or if the bone or its parent is nearly parallel to the axis, so
// that the angle is undetermined.
std::optional<double> told_hinge_angle(const Armature& armature, int bone, const glm::dvec3& axis);
// Returns the angle of a hinge at rest as told_hinge_angle() does, but 0 where that function returns nothing.
double hinge_angle_at_rest(const Armature& armature, int bone, const glm::dvec3& axis);

// Returns the swing of a ball joint at rest, relative to its anatomical position, as a rotation vector. Returns zero if
// the body part has no anatomical position, or if bones that define it are missing, such as the trunk for a shoulder.
glm::dvec3 ball_swing_at_rest(const Armature& armature, int bone, BodyPart part);

// Returns the angle of a hinge, or the swing of a ball joint, at rest as a rotation vector; the type of the bone's
// limits and its name decide which. Added to the rotation vector of a rotation from rest, it gives the anatomical
// angles.
glm::dvec3 turn_at_rest(const Armature& armature, int bone);

}  // namespace limber
