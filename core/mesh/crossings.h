// SPDX-License-Identifier: AGPL-3.0-or-later
// Where a surface cuts or touches itself: pairs of triangles with a common point that is no common corner or edge.
// Decided exactly (predicates.h), found through a grid of cells.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

namespace limber {

// Pairs of rows of F, the smaller first, in ascending order. Triangles that share an edge count where they lie upon
// each other, those that share a corner where they meet elsewhere too; the same for any number of threads.
//   V  #V places (finite)   F  #F corners
std::vector<std::array<int, 2>> crossing_pairs(const Eigen::MatrixX3d& V, const Eigen::MatrixX3i& F);

}  // namespace limber
