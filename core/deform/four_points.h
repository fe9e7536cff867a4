// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes four points at a time, one in each lane of a SIMD register. Each lane gives the same result as a scalar
// double, bit for bit.
#pragma once

#include <cstdint>

#include "core/base/always_inline.h"

#pragma GCC diagnostic ignored "-Wpsabi"  // about how functions take SIMD vectors: all such functions here are inlined

namespace limber {

using FourNumbers = double __attribute__((vector_size(32)));
using FourIntegers = std::int32_t __attribute__((vector_size(16)));

// The alignment of the structures below is explicit, since that of FourNumbers depends on the processor for which a
// function is compiled.

// A point whose coordinates are doubles or FourNumbers.
template <class Number>
struct alignas(sizeof(Number)) PointOf {
  Number x, y, z;
};
// An array of doubles or FourNumbers.
template <class Number, int kCount>
struct alignas(sizeof(Number)) ArrayOf {
  Number values[kCount];
  LIMBER_INLINE Number& operator[](int i) { return values[i]; }
  LIMBER_INLINE const Number& operator[](int i) const { return values[i]; }
};
using FourPoints = PointOf<FourNumbers>;

template <class Number>
LIMBER_INLINE PointOf<Number> operator+(const PointOf<Number>& a, const PointOf<Number>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class Number>
LIMBER_INLINE PointOf<Number> operator-(const PointOf<Number>& a, const PointOf<Number>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class Number, class Factor>
LIMBER_INLINE PointOf<Number> operator*(const Factor& factor, const PointOf<Number>& a) {
  return {factor * a.x, factor * a.y, factor * a.z};
}
template <class Number>
LIMBER_INLINE PointOf<Number> operator/(const PointOf<Number>& a, const Number& divisor) {
  return {a.x / divisor, a.y / divisor, a.z / divisor};
}
template <class Number>
LIMBER_INLINE Number dot(const PointOf<Number>& a, const PointOf<Number>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Number>
LIMBER_INLINE PointOf<Number> cross(const PointOf<Number>& a, const PointOf<Number>& b) {
  return {a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y};
}
// Returns a where the condition is true, and b elsewhere.
template <class Condition, class Number>
LIMBER_INLINE PointOf<Number> select(const Condition& condition, const PointOf<Number>& a, const PointOf<Number>& b) {
  return {condition ? a.x : b.x, condition ? a.y : b.y, condition ? a.z : b.z};
}

}  // namespace limber
