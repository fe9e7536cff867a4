// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes tets that a deformation has turned inside out upright again: a foldover-free map [Garanzha, Kaporin,
// Kudryavtseva, Protais, Ray, Sokolov, Foldover-free maps in 50 lines of code, ACM TOG 40(4), 2021]. Around these tets
// the nodes take the positions in which the tets are least distorted, by an energy that grows without bound as a tet
// becomes flat. For tets that are inside out a regularization makes the energy finite; it is reduced in each round.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/tet_mesh.h"

namespace limber {

// Returns the tets that are inside out or flat, in ascending order.
std::vector<int> tets_inside_out(const Eigen::MatrixX3d& V, const Eigen::MatrixX4i& T);

// Moves nodes near tets that are inside out until no tet is. Returns the number of tets that remain inside out, which
// can happen between nodes that do not move.
//   V      #V positions, mm, that are changed          T      #T tets
//   rest   #V positions in which every tet is upright  fixed  #V, true: the node does not move
std::int64_t untangle(Eigen::MatrixX3d& V, const Eigen::MatrixX3d& rest, const Eigen::MatrixX4i& T,
                      const std::vector<bool>& fixed);

}  // namespace limber
