// SPDX-License-Identifier: AGPL-3.0-or-later
// Rates how certain the match of a bone and a joint is, judged by their names, so that a user can check a retarget map.
#pragma once

#include "core/motion/retarget.h"

namespace limber {

enum class MatchKind {
  None,      // the bone has no joint
  ByHand,    // the names of bone and joint do not match; the user selected the joint
  Chain,     // bone and joint both belong to the spine, or both to the neck, and were matched by their order
  SamePart,  // bone and joint have different names for the same body part
  SameName,
};

// Returns the kind of match of each bone of the armature.
std::vector<MatchKind> match_kinds(const Motion& motion, const Armature& armature, const RetargetMap& map);

// Returns how certain a match of this kind is, [0, 1].
double confidence(MatchKind kind);

}  // namespace limber
