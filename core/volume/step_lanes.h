// SPDX-License-Identifier: AGPL-3.0-or-later
// Functions for 16-bit whole numbers of several lines of voxels at once, with eight of them in a SIMD register. They
// correspond to the functions for floats in float_lanes.h. A sum above 65 535 becomes 65 535.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "core/volume/float_lanes.h"

namespace limber {

using EightSteps = std::uint16_t __attribute__((vector_size(16)));

template <std::size_t kEights>
using StepLanes = std::array<EightSteps, kEights>;

// Adds `rise` to each of the eight numbers of `steps`. A sum above 65 535 becomes 65 535.
inline EightSteps raised(const EightSteps& steps, std::uint16_t rise) {
#ifdef __SSE2__
  return reinterpret_cast<EightSteps>(
      _mm_adds_epu16(reinterpret_cast<__m128i>(steps), reinterpret_cast<__m128i>(EightSteps{} + rise)));
#else
  // All bits of an element of `is_beyond` are set if its sum has overflowed.
  const EightSteps sum = steps + rise, is_beyond = sum < steps;
  return sum | is_beyond;
#endif
}

// Returns the amounts by which `steps` exceed `limits`, 0 where they do not.
inline EightSteps excess(const EightSteps& steps, const EightSteps& limits) {
#ifdef __SSE2__
  return reinterpret_cast<EightSteps>(
      _mm_subs_epu16(reinterpret_cast<__m128i>(steps), reinterpret_cast<__m128i>(limits)));
#else
  const EightSteps is_above = steps > limits;
  return (steps - limits) & is_above;
#endif
}

template <std::size_t kEights>
bool any_above(const StepLanes<kEights>& lanes, std::uint16_t limit) {
  EightSteps above = excess(lanes[0], EightSteps{} + limit);
  for (std::size_t i = 1; i < kEights; ++i) above |= excess(lanes[i], EightSteps{} + limit);
  return holds_for_any(above);
}

// Returns true if at least one number of `lanes` + rise is below the corresponding number of `limits`.
template <std::size_t kEights>
bool any_lower(const StepLanes<kEights>& lanes, std::uint16_t rise, const StepLanes<kEights>& limits) {
  EightSteps below = excess(limits[0], raised(lanes[0], rise));
  for (std::size_t i = 1; i < kEights; ++i) below |= excess(limits[i], raised(lanes[i], rise));
  return holds_for_any(below);
}

// Sets each number of `lowest` to the minimum of itself and the corresponding number of `other` + rise.
template <std::size_t kEights>
void lower(StepLanes<kEights>& lowest, const StepLanes<kEights>& other, std::uint16_t rise) {
  for (std::size_t i = 0; i < kEights; ++i) lowest[i] -= excess(lowest[i], raised(other[i], rise));
}

}  // namespace limber
