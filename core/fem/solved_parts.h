// SPDX-License-Identifier: AGPL-3.0-or-later
// Sorts the tets and nodes of a model by how they take part in a solve: which tets deform, and which nodes bones hold.
#pragma once

#include <vector>

#include "core/fem/solve_pose.h"

namespace limber {

// The mesh's tets that deform and its rigid tets; the nodes that bones hold by springs, and the nodes that move exactly
// with a bone (carried). A tet that one bone holds at every node is rigid, unless it shares a node with flesh: that
// node may give way.
struct SolvedParts {
  Eigen::MatrixX4i elastic, rigid;
  std::vector<TetMaterial> material;  // per elastic tet
  std::vector<char> is_flesh;         // 1 for each elastic tet whose nodes are not all held by one bone
  std::vector<int> pinned, carried;   // nodes that bones hold: those of elastic tets, those of rigid tets only
  std::vector<double> pin_stiffness;
  std::vector<char> in_joint;  // #V: 1 for nodes of tets between two bones

  SolvedParts() = default;
  //   held_by  #V: the bone that holds each node at present, -1: free
  //   size     size of the body relative to an adult (1); divides the springs by its square
  SolvedParts(const FemModel& model, const std::vector<int>& held_by, double size);
};

}  // namespace limber
