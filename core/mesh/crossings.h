// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds where a surface crosses or touches itself: the pairs of triangles that have a point in common other than on an
// edge or corner that they share. A grid of cells finds candidate pairs; exact predicates (predicates.h) decide each.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

namespace limber {

// Returns the pairs of rows of F whose triangles cross, the smaller row first, in ascending order. Triangles that share
// an edge cross if they overlap; triangles that share only a corner cross if they also meet elsewhere. The result does
// not depend on the number of threads.
//   V  #V vertex positions (finite)   F  #F triangles
std::vector<std::array<int, 2>> crossing_pairs(const Eigen::MatrixX3d& V, const Eigen::MatrixX3i& F);

}  // namespace limber
