// SPDX-License-Identifier: AGPL-3.0-or-later
// Springs from nodes to places: how bones hold their nodes. Stiff, but no more than that: where a joint leaves no room,
// bone gives way a little before flesh is crushed.
//   sum of k/2 (x - target)^2, k in kPa mm, of each axis
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/cholesky.h"
#include "core/fem/node_positions.h"

namespace limber {

struct PinForm {
  std::vector<int> node;
  NodePositions stiffness;  // #node by 3, kPa mm
  NodePositions target;     // #node by 3

  double value(const NodePositions& x) const;
  void add_gradient(const NodePositions& x, NodePositions& gradient) const;
  void add_curvature(const Cholesky& matrix, std::span<const int> unknown, std::span<double> values) const;
};

}  // namespace limber
