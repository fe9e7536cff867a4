// SPDX-License-Identifier: AGPL-3.0-or-later
// Places of mesh nodes, mm, or what else has three numbers a node (steps, forces): x y z of one node beside each other.
#pragma once

#include <Eigen/Core>

namespace limber {

using NodePositions = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;  // #V by 3

}  // namespace limber
