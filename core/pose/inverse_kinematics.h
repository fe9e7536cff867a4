// SPDX-License-Identifier: AGPL-3.0-or-later
// Inverse kinematics: finds a pose that brings bone tails to their targets, by damped least squares [Buss 2005,
// Introduction to inverse kinematics] on the joints' own parameters: a hinge has an angle, a ball joint a swing and a
// twist, a free joint a rotation vector. Limits are kept exactly: a parameter at its limit that a step would push
// beyond it is left out of the step (an active set), and every step is cut to the limits.
//
// The search starts from the given pose and ends near it, so that dragging is smooth. Limits make local minima. Where
// the search ends in one, it restarts from other allowed poses, which are the same in every run. For a target that
// cannot be reached it returns the nearest pose found, and Reach::reached is false.
#pragma once

#include <optional>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

struct ReachGoal {
  int bone = 0;          // the bone whose tail is to reach the target
  glm::dvec3 target{0};  // mm
  // Number of bones that may move: the bone itself and those above it. 0: all up to the root.
  int chain = 0;
  // Weight relative to the other goals. A pin is a goal of large weight at the current position of the tail.
  double weight = 1;
};

struct ReachSettings {
  double tolerance = 0.01;  // mm: the distance at which a goal counts as reached
  bool keep_limits = true;
  std::optional<glm::dvec3> pole;  // world, mm; the chain of the first goal bends towards this point
  bool move_root = false;          // whether the root translation may change
  int restarts = 16;               // number of other start poses to try if the first search does not reach the target
};

struct Reach {
  Pose pose;
  double distance = 0;   // mm: distance of the goal that is furthest from its target
  bool reached = false;  // whether all goals are within the tolerance
};

// Finds a pose in which the goals are reached. If it finds none, returns the pose found that is nearest to the goals.
// Throws Error for a bone that does not exist or a target that is not finite.
Reach reach(const Armature& armature, const Pose& start, const std::vector<ReachGoal>& goals,
            const ReachSettings& settings = {});

}  // namespace limber
