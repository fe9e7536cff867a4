// SPDX-License-Identifier: AGPL-3.0-or-later
// Weights after bones were added to the rig, removed from it or put in another order.
#pragma once

#include <optional>

#include "core/skin/skin_weights.h"

namespace limber {

// Weights of bones that become one are added up. Where the order stays, the influences are shared.
//   to      #old bones: the new bone that takes over the weight; -1 for none
//   names   of the new bones
// Nothing where a voxel would be left without a bone.
std::optional<SkinWeights> carried(const SkinWeights& weights, const std::vector<int>& to,
                                   const std::vector<std::string>& names);

}  // namespace limber
