// SPDX-License-Identifier: AGPL-3.0-or-later
// How far joints stand from the anatomical position where the rig is at rest, told by the directions of its bones.
// Usual ranges of motion are counted from that position [AAOS, Joint Motion: Method of Measuring and Recording, 1965:
// the neutral zero method], while a rig's limits are counted from rest: a body that was scanned with a bent elbow rests
// at 60 degrees of flexion.
//   hinge     the straight limb: the bone in line with its parent, seen along the hinge's axis
//   shoulder  the arm hangs along the trunk              hip    the thigh in line with the trunk
//   wrist, neck, head  in line with the parent           ankle  the foot at a right angle to the shank
// Toes, feet, necks and heads run askew in a body that stands straight; up to 30 degrees of that are taken for
// straight. Radians; axes in the world at rest.
#pragma once

#include <optional>
#include <vector>

#include "core/rig/armature.h"
#include "core/rig/joint_names.h"

namespace limber {

// The roles of an armature's bones, by their names.
std::vector<std::optional<JointRole>> roles_of(const Armature& armature);

// The angle of a hinge at rest about that unit axis, -pi .. pi: 0 is straight. Nothing where its bones run along the
// axis, so that they do not tell, and for a bone without parent or of a part of the body that has no straight position.
std::optional<double> told_hinge_angle(const Armature& armature, int bone, const glm::dvec3& axis);
// The same, 0 for nothing.
double hinge_angle_at_rest(const Armature& armature, int bone, const glm::dvec3& axis);

// A ball's swing at rest as a rotation vector, from the anatomical position of that part of the body; zero for other
// parts, and where the bones that it is told by are missing: a shoulder without a trunk.
glm::dvec3 ball_swing_at_rest(const Armature& armature, int bone, BodyPart part);

// Either, by the kind of the bone's limits and its name: a rotation vector, to be added to the rotation vector that
// turns the bone from rest to get the anatomical angles.
glm::dvec3 turn_at_rest(const Armature& armature, int bone);

}  // namespace limber
