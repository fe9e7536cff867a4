// SPDX-License-Identifier: AGPL-3.0-or-later
// Decides exactly on which side of a line or plane a point is, for any doubles that do not overflow. A floating-point
// filter decides clear cases; the others are computed by exact expansions [Shewchuk, Adaptive precision floating-point
// arithmetic and fast robust geometric predicates, 1997].
#pragma once

#include <array>

namespace limber {

// Returns 1 if a, b, c turn counter-clockwise, -1 if clockwise, 0 if they are on one line.
int side_2d(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& c);

// Returns the sign of det(b - a, c - a, d - a): 1 if d is on the side from which a, b, c are seen counter-clockwise.
int side_3d(const std::array<double, 3>& a, const std::array<double, 3>& b, const std::array<double, 3>& c,
            const std::array<double, 3>& d);

}  // namespace limber
