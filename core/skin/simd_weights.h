// SPDX-License-Identifier: AGPL-3.0-or-later
// One bone's weight set in many voxels at once: what WeightRules::set makes of one after the other where nothing is
// locked, to the bit, without jumps, four or eight voxels together, as the processor can.
#pragma once

#include <cstdint>
#include <span>

#include "core/skin/influence.h"

namespace limber {

constexpr int kWeightLanes = 8;  // sizes are whole multiples of this

enum class LaneWidth { Widest, Four };  // the same comes out

// What `bone` has in each.
void weights_of(std::span<const Influence> influences, int bone, std::span<std::uint16_t> weights,
                LaneWidth width = LaneWidth::Widest);

// In each the weight of `bone` becomes what is asked for; the others make room in proportion.
//   heir  gets what the bone leaves where it had everything
void set_weights(std::span<Influence> influences, int bone, int fallback_bone, std::span<const std::uint16_t> weights,
                 LaneWidth width = LaneWidth::Widest);

}  // namespace limber
