// SPDX-License-Identifier: AGPL-3.0-or-later
// Functions that blend the motions of the bones that a point follows. They are inline because they run for every corner
// of every tissue voxel. Influences are spans of (bone, weight) of any length; weights need not sum to one. A point
// stays at rest where its weights sum to zero.
#pragma once

#include <array>
#include <span>

#include "core/deform/skinning.h"

namespace limber {

// Returns the image of a point under the affine map `m`: three columns, then the translation.
inline glm::dvec3 transform(const std::array<double, 12>& m, const glm::dvec3& p) {
  return {m[0] * p.x + m[3] * p.y + m[6] * p.z + m[9], m[1] * p.x + m[4] * p.y + m[7] * p.z + m[10],
          m[2] * p.x + m[5] * p.y + m[8] * p.z + m[11]};
}

// Returns the image of a point under a dual quaternion, which may have any length: it is normalized and applied in one
// step [Kavan 2008, 4.1].
inline glm::dvec3 transform(const std::array<double, 8>& dq, const glm::dvec3& p) {
  const double w = dq[0];
  const glm::dvec3 v(dq[1], dq[2], dq[3]), d(dq[5], dq[6], dq[7]);
  const double squared_length = w * w + glm::dot(v, v);
  const glm::dvec3 move = glm::cross(v, glm::cross(v, p) + w * p) + w * d - dq[4] * v + glm::cross(v, d);
  return p + move * (2 / squared_length);
}

// Adds weight * q or weight * -q to the sum, whichever points in the sum's direction: q and -q are the same rotation.
inline void add_aligned(std::array<double, 8>& sum, const std::array<double, 8>& q, double weight) {
  const double dot = sum[0] * q[0] + sum[1] * q[1] + sum[2] * q[2] + sum[3] * q[3];
  const double signed_weight = dot < 0 ? -weight : weight;
  for (int i = 0; i < 8; ++i) sum[i] += signed_weight * q[i];
}

inline glm::dvec3 blend_linear(std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                               const glm::dvec3& p) {
  std::array<double, 12> sum{};
  double total = 0;
  for (const auto& [bone, weight] : influences) {
    const auto& d = bones[bone].displacement;
    for (int i = 0; i < 12; ++i) sum[i] += weight * d[i];
    total += weight;
  }
  return total > 0 ? p + transform(sum, p) / total : p;
}

// Returns the point blended by dual quaternions.
//   Stretched  whether bones may stretch: their stretches are then blended linearly and applied first
template <bool Stretched>
glm::dvec3 blend_dual(std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                      const glm::dvec3& p) {
  std::array<double, 8> sum{};
  std::array<double, 12> stretch{};
  double total = 0;
  for (const auto& [bone, weight] : influences) {
    add_aligned(sum, bones[bone].dual_quaternion, weight);
    if constexpr (Stretched)
      for (int i = 0; i < 12; ++i) stretch[i] += weight * bones[bone].stretch[i];
    total += weight;
  }
  if (!(total > 0)) return p;
  if constexpr (Stretched) return transform(sum, transform(stretch, p) / total);
  return transform(sum, p);
}

}  // namespace limber
