// SPDX-License-Identifier: AGPL-3.0-or-later
// How a whole pose stands to the joint limits of its rig. A joint without limits is neither within nor beyond them.
#pragma once

#include <string>

#include "core/rig/pose.h"

namespace limber {

struct LimitCheck {
  int limited = 0;             // bones that have limits
  int unlimited = 0;           // bones with a parent that have none
  int beyond = 0;              // of `limited`: turned further than `tolerance` beyond
  int first = -1, worst = -1;  // of those beyond, the first one and the one that is furthest; -1 where none is
  double excess = 0;           // of the worst, radians
};

//   tolerance  radians
LimitCheck check_limits(const Armature& armature, const Pose& pose, double tolerance);

// "all within", "3 within, 2 without limits", "Forearm is beyond", "Forearm and 2 more are beyond"; "the rig has none".
std::string words_of(const LimitCheck& check, const Armature& armature);

}  // namespace limber
