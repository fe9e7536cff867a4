// SPDX-License-Identifier: AGPL-3.0-or-later
// On which side a point lies, decided exactly for any doubles (short of overflow): a filter first, then expansions
// [Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates, 1997].
#pragma once

#include <array>

namespace limber {

// 1 where a, b, c turn counter-clockwise, -1 clockwise, 0 on one line.
int side_2d(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& c);

// The sign of (b - a, c - a, d - a): 1 where d lies on the side from which a, b, c turn counter-clockwise.
int side_3d(const std::array<double, 3>& a, const std::array<double, 3>& b, const std::array<double, 3>& c,
            const std::array<double, 3>& d);

}  // namespace limber
