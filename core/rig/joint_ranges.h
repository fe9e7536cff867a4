// SPDX-License-Identifier: AGPL-3.0-or-later
// Sets the usual ranges of motion of an adult's joints as limits of a rig's bones. The ranges are those of the American
// Academy of Orthopaedic Surgeons [Joint Motion: Method of Measuring and Recording, 1965], measured from the anatomical
// position. anatomical_position.h finds each joint's angle in the rest pose, which converts the ranges to limits
// relative to the rest pose. The rest pose itself is always allowed. A bone's limits are those of the joint at its
// head.
//
// The cone of a ball joint is the joint's widest motion minus its swing at rest, but large enough to reach the
// anatomical position. Since a cone is round, it allows more than a body does in directions in which the body moves
// less. The pronation of a forearm is part of the wrist's twist, since the elbow is a hinge and cannot twist. If
// several bones form one joint (spine, neck), each gets an equal share of the range.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/rig/armature.h"

namespace limber {

// Returns the names of the joints with usual ranges, from the neck down, as the user sees them: "Shoulder", "Elbow",
// "Finger, middle joint", ...
std::vector<std::string> usual_joints();

// Returns, for each bone, the index of its joint in usual_joints(), found from the bone's name. Returns nothing for a
// bone with an unknown name, or whose joint has no usual range.
std::vector<std::optional<int>> usual_joints_of(const Armature& armature);

// Returns the usual limits of a joint (index into usual_joints()) for a bone. A bone that is a hinge already keeps its
// axis, which is reversed if the bone is bent the other way at rest. The axis of a new hinge is perpendicular to the
// bone and its parent. If these are in line, the axis makes the joint bend as in a body: elbows and fingers forward,
// knees backward, toes down.
JointLimits usual_limits(const Armature& armature, int bone, int joint);

// Returns a bone's limits as text, such as "hinge, 0 to 150 degrees". The angles of a hinge are relative to the
// anatomical position, the angles of a ball joint to the rest pose.
std::string limits_text(const Armature& armature, int bone);

}  // namespace limber
