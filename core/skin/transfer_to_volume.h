// SPDX-License-Identifier: AGPL-3.0-or-later
// Adapts weights after bones were added to the rig, removed from it or reordered.
#pragma once

#include <optional>

#include "core/skin/skin_weights.h"

namespace limber {

// Returns the weights for the changed rig, or nothing if some voxel would be left without a bone. If several old bones
// become one new bone, their weights are added. If no bone changes its index, the chunks are shared with `weights`.
//   to      for each old bone: the new bone that takes over its weight; -1: none
//   names   names of the new bones
std::optional<SkinWeights> carried(const SkinWeights& weights, const std::vector<int>& to,
                                   const std::vector<std::string>& names);

}  // namespace limber
