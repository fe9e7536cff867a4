// SPDX-License-Identifier: AGPL-3.0-or-later
// Usual ranges of motion of the joints of an adult, as limits of a rig's bones. Angles are those of the American
// Academy of Orthopaedic Surgeons [Joint Motion: Method of Measuring and Recording, 1965], counted from the anatomical
// position as the rig's bones tell it (anatomical_position.h); limits are what is left of them from the rest pose on,
// which is always allowed. A bone's limits are those of the joint at its head.
//
// A cone is as wide as what is left of the joint's widest motion, and reaches back to the anatomical position, so a
// ball allows more to the other sides than the body does. Forearms turn about themselves at the wrist here, since a
// hinge cannot. Where several bones make one joint (spine, neck) they share it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/rig/armature.h"

namespace limber {

// "Shoulder", "Elbow", "Finger, middle joint"...: what a user chooses from, from the head down.
std::vector<std::string> usual_joints();

// Which of usual_joints() each bone's name means; nothing for a bone that has no range of its own, or whose name means
// nothing known.
std::vector<std::optional<int>> usual_joints_of(const Armature& armature);

// The limits of that joint for that bone. A hinge keeps the axis it has, the other way round where the bone is bent
// against it; else it lies across the bone and its parent, and where those are straight so that it bends as the body
// does: elbows and fingers forward, knees backward, toes down.
JointLimits usual_limits(const Armature& armature, int bone, int joint);

// "hinge, 0 to 150 degrees": what a bone's limits allow, in words; a hinge's angles as the anatomist counts them.
std::string limits_text(const Armature& armature, int bone);

}  // namespace limber
