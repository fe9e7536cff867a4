// SPDX-License-Identifier: AGPL-3.0-or-later
// The motion of one joint: the turns for which the joint is judged and repaired. Only the bones below the joint move.
#pragma once

#include <optional>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

struct JointTurn {
  glm::dvec3 axis{0};  // unit axis through the joint, world at rest
  double angle = 0;    // angle of the turn, radians; not zero
};

struct JointMotion {
  int bone = -1;                 // the bone below the joint
  glm::dvec3 centre{0};          // position of the joint, world at rest, mm
  std::vector<JointTurn> turns;  // at most 22.5 degrees apart; the rest pose is not included
  std::vector<int> moving;       // the bone below the joint, then all its descendants
};

// The range of a joint's angle about its axis, degrees from rest.
struct TurnRange {
  double low = 0, high = 90;
};

// Returns the motion of the joint at a bone's head. If a range is given, the joint turns about the hinge that the rig
// gives it. If the rig gives the joint no limits, it turns about the usual hinge for its name. All other joints turn
// about flex_axis(). Without a given range the joint moves as joints of its kind do:
//   a hinge, or a joint whose name has a usual hinge (rig/joint_ranges.h): over the hinge's range
//   a hip or shoulder, recognised by name: flexion, extension and abduction (pose/joint_angles.h)
//   another ball joint: swings in both directions about two axes perpendicular to the bone, up to its cone
//   any other joint: 0 to 90 degrees about flex_axis()
// Turns of less than 5 degrees are left out and, if no range is given, turns of more than 120 degrees from rest. Throws
// Error for a bone without a parent, for a range that is not -170 <= low <= 0 <= high <= 170 or has no turn of 5
// degrees, and as flex_axis() does.
JointMotion joint_motion(const Armature& armature, int bone, const std::optional<TurnRange>& range);

// Returns the rest pose with the joint rotated by one of its turns.
Pose turned(const Armature& armature, const JointMotion& motion, const JointTurn& turn);

}  // namespace limber
