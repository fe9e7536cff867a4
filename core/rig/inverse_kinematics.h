// SPDX-License-Identifier: AGPL-3.0-or-later
// Inverse kinematics: finds a pose that brings bone tails to their targets, by damped least squares [Buss 2005,
// Introduction to inverse kinematics] on the joints' own parameters: a hinge has an angle, a ball joint a swing and a
// twist, a free joint a rotation vector. Limits are kept exactly: a parameter at its limit is left out of a step that
// would exceed the limit (an active set), and every step is cut to the limits.
//
// The search starts from the given pose and ends near it, so that dragging is smooth. Joint limits cause local minima.
// If the search ends in a local minimum, it restarts from other allowed poses, which are the same in every run. If a
// target cannot be reached, the result is the nearest pose found, with Reach::reached false.
#pragma once

#include <optional>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

struct ReachGoal {
  int bone = 0;          // the bone whose tail is to reach the target
  glm::dvec3 target{0};  // where the tail is to be, world, mm
  // Number of bones that may move, counted from the bone itself upwards. 0: all bones up to the root.
  int chain = 0;
  // Weight relative to the other goals. A pin (a bone whose tail stays in place) is a goal of large weight.
  double weight = 1;
};

struct ReachSettings {
  double tolerance = 0.01;  // distance from its target, mm, at which a tail has reached it
  bool keep_limits = true;
  std::optional<glm::dvec3> pole;  // world, mm; the chain of the first goal bends towards this point
  bool move_root = false;          // true: the whole body may also be translated
  int restarts = 16;               // number of other start poses to try if the first search does not reach the target
};

struct Reach {
  Pose pose;
  double distance = 0;   // largest distance between a bone's tail and its target, mm
  bool reached = false;  // true: all tails are at their targets, within the tolerance
};

// Finds a pose in which all goals are reached. If there is none, returns the nearest pose that was found. Throws Error
// for a bone that does not exist or a target that is not finite.
Reach reach(const Armature& armature, const Pose& start, const std::vector<ReachGoal>& goals,
            const ReachSettings& settings = {});

}  // namespace limber
