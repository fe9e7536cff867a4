// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/blend_kernels.h"
#include "core/deform/blend_rule.h"

namespace limber {

extern const BlendRule kLinearBlend;

// The displacement of a bone already contains its stretch, so one function serves for bones with and without stretch.
const BlendRule kLinearBlend{
    .word = "lbs",
    .label = "LBS",
    .name = "Linear blend",
    .summary = "linear",
    .description = "Linear blending: quick, loses volume at bent and twisted joints.",
    .point = blend_linear,
    .stretched_point = blend_linear,
    .sums_displacements = true,
    .sums_dual_quaternions = false,
    .settles_flesh = false,
};

}  // namespace limber
