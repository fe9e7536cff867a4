// SPDX-License-Identifier: AGPL-3.0-or-later
// The energy of springs from nodes to target positions. Springs connect the nodes of bones to the posed bones:
//    the sum over nodes and axes of k/2 (x - target)^2, k in kPa mm
// Springs are stiff but not rigid: where flesh has no room between two bones, the bones' nodes yield a little, so that
// the flesh is not crushed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/cholesky.h"
#include "core/fem/node_positions.h"

namespace limber {

struct PinForm {
  std::vector<int> node;
  NodePositions stiffness;  // spring stiffness along each axis, one row per entry of `node`, kPa mm
  NodePositions target;     // target positions, one row per entry of `node`, mm

  double value(const NodePositions& x) const;
  void add_gradient(const NodePositions& x, NodePositions& gradient) const;
  void add_curvature(const Cholesky& matrix, std::span<const int> unknown, std::span<double> values) const;
};

}  // namespace limber
