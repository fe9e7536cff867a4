// SPDX-License-Identifier: AGPL-3.0-or-later
// Sets one bone's weight in many voxels at once. The result for each voxel is bit for bit that of WeightRules::set
// without locked bones. This code has no branches, and processes four or eight voxels at a time, as the processor
// allows.
#pragma once

#include <cstdint>
#include <span>

#include "core/skin/influence.h"

namespace limber {

constexpr int kWeightLanes = 8;  // the number of voxels must be a multiple of this

enum class LaneWidth { Widest, Four };  // both give the same result

// Writes the weight of `bone` in each voxel to `weights`.
void weights_of(std::span<const Influence> influences, int bone, std::span<std::uint16_t> weights,
                LaneWidth width = LaneWidth::Widest);

// Sets the weight of `bone` in each voxel. The other bones make room in proportion to their weights.
//   fallback_bone  gets the rest in voxels in which `bone` had all the weight
void set_weights(std::span<Influence> influences, int bone, int fallback_bone, std::span<const std::uint16_t> weights,
                 LaneWidth width = LaneWidth::Widest);

}  // namespace limber
