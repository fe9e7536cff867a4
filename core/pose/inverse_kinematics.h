// SPDX-License-Identifier: AGPL-3.0-or-later
// Poses that bring bone ends to where they are wanted, by damped least squares [Buss 2005, Introduction to inverse
// kinematics] on the joints' own parameters: a hinge has its angle, a ball its swing and twist, a free joint a rotation
// vector. Limits are kept exactly: parameters at a limit that would be pushed beyond it are left out of a step (an
// active set), and every step is cut to the limits.
//
// The search starts from the pose it is given and ends near it, so that dragging is smooth. Limits make local minima;
// where one is met the search starts anew from other allowed poses, always the same ones. What cannot be reached comes
// as near as was found, and is said.
#pragma once

#include <optional>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

struct ReachGoal {
  int bone = 0;          // its tail is to come to
  glm::dvec3 target{0};  // mm
  int chain = 0;         // so many bones move: the bone itself and those above it; 0 for all up to the root
  double weight = 1;     // against the other goals; a pin is a goal of large weight where the tail is already
};

struct ReachSettings {
  double tolerance = 0.01;  // mm, of every goal
  bool keep_limits = true;
  std::optional<glm::dvec3> pole;  // the first goal's chain bends towards this point
  bool move_root = false;          // the root translation may change too
  int restarts = 16;               // other poses to start from, where the first search does not arrive
};

struct Reach {
  Pose pose;
  double distance = 0;   // mm, of the goal that is furthest off
  bool reached = false;  // within the tolerance
};

// Throws Error for a bone that does not exist or a target that is not finite.
Reach reach(const Armature& armature, const Pose& start, const std::vector<ReachGoal>& goals,
            const ReachSettings& settings = {});

}  // namespace limber
