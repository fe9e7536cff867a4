// SPDX-License-Identifier: AGPL-3.0-or-later
// Weights that were computed anew, taken over in part: for some bones, in a region, under locks. What is not asked for
// stays as it was painted, as far as sums allow.
#pragma once

#include "core/skin/weight_edits.h"

namespace limber {

//   computed  of the same body and bones
//   bones     get their computed weight; the others share what that leaves as they did before (where they had nothing,
//   as
//             computed). Empty: all bones.
// A locked bone keeps its weight; the others share what it leaves.
WeightEdit recomputed(const WeightedBody& body, const SkinWeights& weights, const SkinWeights& computed,
                      const std::vector<int>& bones = {}, const EditScope& scope = {.rigid_bone_tissue = false});

}  // namespace limber
