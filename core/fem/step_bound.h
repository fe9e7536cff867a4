// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes how far nodes may move along a step before a tet would lose nine tenths of its volume. The volume of a tet
// whose nodes move along straight lines is a cubic function of the step's length, so its first root gives the exact
// result. A flat tet is hard to unfold. So a larger volume that must be left can also be given for each tet. If a tet's
// volume is less than twice that, half of its current volume must be left.
#pragma once

#include <cstdint>
#include <span>

#include "core/fem/node_positions.h"

namespace limber {

struct StepBound {
  double length;     // share of the step that is possible, at most `limit`
  std::int64_t tet;  // index of the tet that limits the step, -1: none
};

// Returns the largest share of `step`, up to `limit`, after which every tet has enough of its volume left.
//   T     #T tets, all with positive volume at x
//   keep  #T: six times the volume that each tet must keep, mm3; empty: none
StepBound largest_step(const Eigen::MatrixX4i& T, const NodePositions& x, const NodePositions& step, double limit,
                       std::span<const double> keep = {});

// Returns six times the signed volume of tet (a, b, c, d), mm3.
double determinant(const NodePositions& x, int a, int b, int c, int d);

// Returns the number of tets without positive volume.
std::int64_t count_inverted(const Eigen::MatrixX4i& T, const NodePositions& x);

}  // namespace limber
