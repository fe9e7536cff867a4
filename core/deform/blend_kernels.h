// SPDX-License-Identifier: AGPL-3.0-or-later
// Functions that blend the motions of the bones that a point follows. They are inline because they run for every corner
// of every tissue voxel. Each is a template over its number type: double for one point, or FourNumbers for four points
// at a time (four_points.h). Influences are spans of (bone, weight) of any length; weights need not sum to one. A point
// whose weights sum to zero stays at rest.
#pragma once

#include <array>
#include <span>

#include "core/deform/blend_rule.h"
#include "core/deform/four_points.h"
#include "core/deform/skinning.h"

namespace limber {

// Returns the image of a point under the affine map `m`: the three columns of the matrix, then the translation.
template <class Number>
LIMBER_INLINE PointOf<Number> transform(const ArrayOf<Number, 12>& m, const PointOf<Number>& p) {
  return {m[0] * p.x + m[3] * p.y + m[6] * p.z + m[9], m[1] * p.x + m[4] * p.y + m[7] * p.z + m[10],
          m[2] * p.x + m[5] * p.y + m[8] * p.z + m[11]};
}

// Returns the image of a point under a dual quaternion of any length other than zero: normalizes and applies it in one
// step [Kavan 2008, 4.1].
template <class Number>
LIMBER_INLINE PointOf<Number> transform(const ArrayOf<Number, 8>& dq, const PointOf<Number>& p) {
  const Number w = dq[0];
  const PointOf<Number> v{dq[1], dq[2], dq[3]}, d{dq[5], dq[6], dq[7]};
  const Number squared_length = w * w + dot(v, v);
  const PointOf<Number> move = cross(v, cross(v, p) + w * p) + w * d - dq[4] * v + cross(v, d);
  return p + 2.0 / squared_length * move;
}

// Adds weight * q or weight * -q to the sum, whichever has a positive dot product with the sum: q and -q are the same
// rotation.
template <class Sum, class Number>
LIMBER_INLINE void add_aligned(Sum& sum, const std::array<double, 8>& q, const Number& weight) {
  const Number dot = sum[0] * q[0] + sum[1] * q[1] + sum[2] * q[2] + sum[3] * q[3];
  const Number signed_weight = dot < 0.0 ? -weight : weight;
  for (int i = 0; i < 8; ++i) sum[i] += signed_weight * q[i];
}

// Each kernel's blend() returns the blended point.
//   Influence  BoneWeight or FourWeights
//   Stretched  true: bones may stretch

// Blends the displacements of the bones linearly. The displacements already contain the bones' stretches.
struct LinearKernel {
  template <bool Stretched, class Influence, class Number>
  LIMBER_INLINE static PointOf<Number> blend(std::span<const SkinTransform> bones,
                                             std::span<const Influence> influences, const PointOf<Number>& p) {
    ArrayOf<Number, 12> sum{};
    Number total{};
    for (const auto& [bone, weight] : influences) {
      const auto& d = bones[bone].displacement;
      for (int i = 0; i < 12; ++i) sum[i] += weight * d[i];
      total += weight;
    }
    return select(total > 0.0, p + transform(sum, p) / total, p);
  }
};

// Blends dual quaternions. Stretches are blended linearly and applied first.
struct DualKernel {
  template <bool Stretched, class Influence, class Number>
  LIMBER_INLINE static PointOf<Number> blend(std::span<const SkinTransform> bones,
                                             std::span<const Influence> influences, const PointOf<Number>& p) {
    ArrayOf<Number, 8> sum{};
    ArrayOf<Number, 12> stretch{};
    Number total{};
    for (const auto& [bone, weight] : influences) {
      add_aligned(sum, bones[bone].dual_quaternion, weight);
      if constexpr (Stretched)
        for (int i = 0; i < 12; ++i) stretch[i] += weight * bones[bone].stretch[i];
      total += weight;
    }
    if constexpr (Stretched) return select(total > 0.0, transform(sum, transform(stretch, p) / total), p);
    return select(total > 0.0, transform(sum, p), p);
  }
};

// Functions to which the pointers of a BlendRule point: they blend by `Kernel` one point, four points, and four points
// with the instruction set AVX2.
template <class Kernel, bool Stretched>
glm::dvec3 blend_one(std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                     const glm::dvec3& p) {
  const auto posed = Kernel::template blend<Stretched>(bones, influences, PointOf<double>{p.x, p.y, p.z});
  return {posed.x, posed.y, posed.z};
}
template <class Kernel>
void blend_four(std::span<const SkinTransform> bones, std::span<const FourWeights> influences, FourPoints& points) {
  points = Kernel::template blend<false>(bones, influences, FourPoints(points));
}
#ifdef __x86_64__
template <class Kernel>
[[gnu::target("avx2")]] void blend_four_wide(std::span<const SkinTransform> bones,
                                             std::span<const FourWeights> influences, FourPoints& points) {
  points = Kernel::template blend<false>(bones, influences, FourPoints(points));
}
#else
template <class Kernel>
constexpr BlendRule::Four blend_four_wide = blend_four<Kernel>;
#endif

}  // namespace limber
