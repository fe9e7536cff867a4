// SPDX-License-Identifier: AGPL-3.0-or-later
// How far nodes may go along a step before a tet would lose nine tenths of its volume, exactly: the volume of a tet
// whose nodes move straight is a cubic, whose first root is looked for, not guessed. What is pressed flat is hard to
// unfold: so a tet may have a volume that it must keep too, or half of what it has where that is less.
#pragma once

#include <cstdint>
#include <span>

#include "core/fem/node_positions.h"

namespace limber {

struct StepBound {
  double length;     // of the step, at most `limit`
  std::int64_t tet;  // that bounds it, -1 none
};

// T     #T corners, all with positive volume at x
// keep  #T: six times the volume that each must keep; empty: none
StepBound largest_step(const Eigen::MatrixX4i& T, const NodePositions& x, const NodePositions& step, double limit,
                       std::span<const double> keep = {});

// Six times the volume of tet (a, b, c, d).
double determinant(const NodePositions& x, int a, int b, int c, int d);

// Tets without positive volume.
std::int64_t count_inverted(const Eigen::MatrixX4i& T, const NodePositions& x);

}  // namespace limber
