// SPDX-License-Identifier: AGPL-3.0-or-later
// Sets the usual ranges of motion of an adult's joints as limits of a rig's bones. Angles are those of the American
// Academy of Orthopaedic Surgeons [Joint Motion: Method of Measuring and Recording, 1965], relative to the anatomical
// position, which the directions of the rig's bones give (anatomical_position.h). Limits are the same ranges relative
// to the rest pose, which is always allowed. A bone's limits are those of the joint at its head.
//
// The cone of a ball joint is the joint's widest motion, less the swing at rest, but always reaches back to the
// anatomical position. Since a cone is round, it allows more in other directions than the body does. Forearms twist at
// the wrist here, since a hinge cannot twist. Several bones that form one joint (spine, neck) share its range equally.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/rig/armature.h"

namespace limber {

// Returns the names of the joints from which a user selects, from the neck down: "Shoulder", "Elbow", "Finger, middle
// joint", ...
std::vector<std::string> usual_joints();

// Returns, for each bone, the index into usual_joints() that its name means; nothing if the joint has no usual range,
// or the name is unknown.
std::vector<std::optional<int>> usual_joints_of(const Armature& armature);

// Returns the usual limits of a joint for a bone. A hinge keeps its axis, or gets the opposite one if the bone is bent
// against it at rest. A new hinge's axis is perpendicular to the bone and its parent. If these are in line, the axis
// makes the joint bend as in a body: elbows and fingers forward, knees backward, toes down.
JointLimits usual_limits(const Armature& armature, int bone, int joint);

// Returns a bone's limits as text, such as "hinge, 0 to 150 degrees". A hinge's angles are relative to the anatomical
// position.
std::string limits_text(const Armature& armature, int bone);

}  // namespace limber
