// SPDX-License-Identifier: AGPL-3.0-or-later
// The positions of mesh nodes in mm, or other vectors per node (steps, forces). The x, y and z of a node are adjacent
// in memory.
#pragma once

#include <Eigen/Core>

namespace limber {

using NodePositions = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;  // #V by 3, stored row by row

}  // namespace limber
