// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/blend_kernels.h"

namespace limber {

extern const BlendRule kDualQuaternionBlend;

const BlendRule kDualQuaternionBlend{
    .word = "dqs",
    .label = "DQ",
    .name = "Dual quaternions",
    .summary = "dual quaternions",
    .description = "Dual quaternions: keep the thickness of twisted limbs, but bulge at shoulders.",
    .point = blend_one<DualKernel, false>,
    .stretched_point = blend_one<DualKernel, true>,
    .four_points = blend_four<DualKernel>,
    .four_points_wide = blend_four_wide<DualKernel>,
    .sums_displacements = false,
    .sums_dual_quaternions = true,
    .settles_flesh = false,
};

}  // namespace limber
