// SPDX-License-Identifier: AGPL-3.0-or-later
// Merges newly computed weights into existing ones, only for some bones or only in a region. All other weights stay as
// they were painted, as far as the sums allow.
#pragma once

#include "core/skin/weight_edits.h"

namespace limber {

// Returns `weights` with the computed weights of `bones` (empty: of all bones). The other bones share the rest in
// proportion to their old weights, or to their computed weights where they had none. A locked bone keeps its weight.
//   computed  weights of the same body and bones
WeightEdit recomputed(const WeightedBody& body, const SkinWeights& weights, const SkinWeights& computed,
                      const std::vector<int>& bones = {}, const EditScope& scope = {.rigid_bone_tissue = false});

}  // namespace limber
