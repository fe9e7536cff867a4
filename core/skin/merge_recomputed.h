// SPDX-License-Identifier: AGPL-3.0-or-later
// Merges newly computed weights into existing weights, for some bones only or in a region only. All other weights stay
// as painted, except where a voxel's weights would no longer sum to 1.
#pragma once

#include "core/skin/weight_edits.h"

namespace limber {

// Returns `weights` with the computed weights of `bones` (empty: of all bones). The remaining bones share the remaining
// weight in proportion to their old weights, or to their computed weights where they had none. The weight of a locked
// bone does not change.
//   computed  weights of the same body and bones
WeightEdit recomputed(const WeightedBody& body, const SkinWeights& weights, const SkinWeights& computed,
                      const std::vector<int>& bones = {}, const EditScope& scope = {.rigid_bone_tissue = false});

}  // namespace limber
