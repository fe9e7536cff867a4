// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks a whole pose against the joint limits of its rig. A joint without limits is counted separately, as neither
// within nor beyond its limits.
#pragma once

#include <string>

#include "core/rig/pose.h"

namespace limber {

struct LimitCheck {
  int limited = 0;             // number of bones that have limits
  int unlimited = 0;           // number of bones with a parent but without limits
  int beyond = 0;              // number of bones turned more than `tolerance` beyond their limits
  int first = -1, worst = -1;  // bone indices: the first bone beyond its limits, and the bone furthest beyond; -1: none
  double excess = 0;           // largest angle by which a bone exceeds its limits, radians
};

// Compares each bone's rotation with its limits.
//   tolerance  angle, in radians, by which a bone may exceed its limits without being counted
LimitCheck check_limits(const Armature& armature, const Pose& pose, double tolerance);

// Describes the result of a check, to be shown after the words "Joint limits": "all within", "3 within, 2 without
// limits", "Forearm is beyond", "Forearm and 2 more are beyond" or "the rig has none".
std::string words_of(const LimitCheck& check, const Armature& armature);

}  // namespace limber
