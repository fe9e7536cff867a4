// SPDX-License-Identifier: AGPL-3.0-or-later
// How sure it is that a joint moves a bone, by their names: for a user to look over a map.
#pragma once

#include "core/motion/retarget.h"

namespace limber {

enum class MatchKind {
  None,      // nothing moves the bone
  ByHand,    // the names do not say it
  Chain,     // both of the spine, or of the neck, told apart by their places
  SamePart,  // other names for the same part of the body
  SameName,
};

// By bone of the armature. `map` as Retarget takes it.
std::vector<MatchKind> match_kinds(const Motion& motion, const Armature& armature, const RetargetMap& map);

// [0, 1]
double confidence(MatchKind kind);

}  // namespace limber
