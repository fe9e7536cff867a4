// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/blend_kernels.h"

namespace limber {

extern const BlendRule kMixedBlend;

namespace {

struct MixedKernel {
  template <bool Stretched, class Influence, class Number>
  LIMBER_INLINE static PointOf<Number> blend(std::span<const SkinTransform> bones,
                                             std::span<const Influence> influences, const PointOf<Number>& p) {
    const PointOf<Number> linear = LinearKernel::blend<Stretched>(bones, influences, p) - p,
                          dual = DualKernel::blend<Stretched>(bones, influences, p) - p;
    return p + ((1 - kQuaternionShare) * linear + kQuaternionShare * dual);
  }
};

}  // namespace

const BlendRule kMixedBlend{
    .word = "mix",
    .label = "Mixed",
    .name = "Mixed blend",
    .summary = "between linear and dual quaternions, then restores the volume of soft tissue",
    .description =
        "Mixed blending: between linear and dual quaternions. Resampling then restores the volume of soft tissue.",
    .point = blend_one<MixedKernel, false>,
    .stretched_point = blend_one<MixedKernel, true>,
    .four_points = blend_four<MixedKernel>,
    .four_points_wide = blend_four_wide<MixedKernel>,
    .sums_displacements = true,
    .sums_dual_quaternions = true,
    .settles_flesh = true,
};

}  // namespace limber
