// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/blend_kernels.h"
#include "core/deform/blend_rule.h"

namespace limber {

extern const BlendRule kDualQuaternionBlend;

const BlendRule kDualQuaternionBlend{
    .word = "dqs",
    .label = "DQ",
    .name = "Dual quaternions",
    .summary = "dual quaternions",
    .description = "Dual quaternions: keeps the thickness of twisted limbs, bulges at shoulders.",
    .point = blend_dual<false>,
    .stretched_point = blend_dual<true>,
    .sums_displacements = false,
    .sums_dual_quaternions = true,
    .settles_flesh = false,
};

}  // namespace limber
