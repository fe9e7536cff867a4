// SPDX-License-Identifier: AGPL-3.0-or-later
// Sets one bone's weight in many voxels at once. For each voxel, the result is bit for bit that of WeightRules::set
// without locked bones. The code has no branches. It processes four or eight voxels at a time, depending on the
// processor.
#pragma once

#include <cstdint>
#include <span>

#include "core/skin/influence.h"

namespace limber {

constexpr int kWeightLanes = 8;  // the number of voxels must be a multiple of this

// Number of voxels that are processed at a time: as many as the processor can, or four. The results are equal.
enum class LaneWidth { Widest, Four };

// Writes the weight of `bone` in each voxel to `weights`, one entry for each influence.
void weights_of(std::span<const Influence> influences, int bone, std::span<std::uint16_t> weights,
                LaneWidth width = LaneWidth::Widest);

// Sets the weight of `bone` in each voxel to the voxel's entry of `weights`. The voxel's other bones make room in
// proportion to their weights.
//   fallback_bone  gets the remaining weight in voxels in which `bone` had all the weight
void set_weights(std::span<Influence> influences, int bone, int fallback_bone, std::span<const std::uint16_t> weights,
                 LaneWidth width = LaneWidth::Widest);

}  // namespace limber
