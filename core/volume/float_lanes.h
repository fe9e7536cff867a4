// SPDX-License-Identifier: AGPL-3.0-or-later
// Floats of several lines of voxels side by side, four in a register. For minima of plain arrays of floats compilers
// use one instruction a float.
#pragma once

#include <array>
#include <cstddef>

namespace limber {

using FourFloats = float __attribute__((vector_size(16)));

template <std::size_t kFours>
using FloatLanes = std::array<FourFloats, kFours>;

template <std::size_t kFours>
bool any_above(const FloatLanes<kFours>& lanes, float limit) {
  auto above = lanes[0] > FourFloats{} + limit;
  for (std::size_t i = 1; i < kFours; ++i) above |= lanes[i] > FourFloats{} + limit;
  return above[0] | above[1] | above[2] | above[3];
}

// Each of `lowest` becomes the least of itself and of `other` + rise.
template <std::size_t kFours>
void lower(FloatLanes<kFours>& lowest, const FloatLanes<kFours>& other, float rise) {
  for (std::size_t i = 0; i < kFours; ++i) {
    const FourFloats risen = other[i] + rise;
    lowest[i] = risen < lowest[i] ? risen : lowest[i];
  }
}

}  // namespace limber
