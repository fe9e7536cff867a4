// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/blend_kernels.h"
#include "core/deform/blend_rule.h"

namespace limber {

extern const BlendRule kMixedBlend;

namespace {

template <bool Stretched>
glm::dvec3 blend_mixed(std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                       const glm::dvec3& p) {
  const glm::dvec3 linear = blend_linear(bones, influences, p) - p,
                   dual = blend_dual<Stretched>(bones, influences, p) - p;
  return p + ((1 - kQuaternionShare) * linear + kQuaternionShare * dual);
}

}  // namespace

const BlendRule kMixedBlend{
    .word = "mix",
    .label = "Mixed",
    .name = "Mixed blend",
    .summary = "between linear and dual quaternions, then flesh gets its volume back",
    .description = "Between linear and dual quaternions; in results flesh then gets its volume back.",
    .point = blend_mixed<false>,
    .stretched_point = blend_mixed<true>,
    .sums_displacements = true,
    .sums_dual_quaternions = true,
    .settles_flesh = true,
};

}  // namespace limber
