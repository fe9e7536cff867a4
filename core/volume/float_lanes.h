// SPDX-License-Identifier: AGPL-3.0-or-later
// Functions for floats of several lines of voxels at once, with four floats in a SIMD register. The register type is
// explicit because compilers take the minimum of two plain arrays one float at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace limber {

using FourFloats = float __attribute__((vector_size(16)));

template <std::size_t kFours>
using FloatLanes = std::array<FourFloats, kFours>;

// Returns true if the comparison that made the mask holds for at least one float.
template <class Mask>
bool holds_for_any(const Mask& mask) {
  using Words = std::int64_t __attribute__((vector_size(16)));
  const Words words = reinterpret_cast<Words>(mask);
  return (words[0] | words[1]) != 0;
}

template <std::size_t kFours>
bool any_above(const FloatLanes<kFours>& lanes, float limit) {
  auto above = lanes[0] > FourFloats{} + limit;
  for (std::size_t i = 1; i < kFours; ++i) above |= lanes[i] > FourFloats{} + limit;
  return holds_for_any(above);
}

// Returns true if at least one float of `lanes` + rise is below the corresponding float of `limits`.
template <std::size_t kFours>
bool any_lower(const FloatLanes<kFours>& lanes, float rise, const FloatLanes<kFours>& limits) {
  auto below = lanes[0] + rise < limits[0];
  for (std::size_t i = 1; i < kFours; ++i) below |= lanes[i] + rise < limits[i];
  return holds_for_any(below);
}

// Sets each float of `lowest` to the minimum of itself and the corresponding float of `other` + rise.
template <std::size_t kFours>
void lower(FloatLanes<kFours>& lowest, const FloatLanes<kFours>& other, float rise) {
  for (std::size_t i = 0; i < kFours; ++i) {
    const FourFloats risen = other[i] + rise;
    lowest[i] = risen < lowest[i] ? risen : lowest[i];
  }
}

}  // namespace limber
