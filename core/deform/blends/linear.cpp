// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/blend_kernels.h"

namespace limber {

extern const BlendRule kLinearBlend;

const BlendRule kLinearBlend{
    .word = "lbs",
    .label = "LBS",
    .name = "Linear blend",
    .summary = "linear",
    .description = "Linear blending: fast, but loses volume at bent and twisted joints.",
    .point = blend_one<LinearKernel, false>,
    .stretched_point = blend_one<LinearKernel, true>,
    .four_points = blend_four<LinearKernel>,
    .four_points_wide = blend_four_wide<LinearKernel>,
    .sums_displacements = true,
    .sums_dual_quaternions = false,
    .settles_flesh = false,
};

}  // namespace limber
