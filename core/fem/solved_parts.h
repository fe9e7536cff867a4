// SPDX-License-Identifier: AGPL-3.0-or-later
// Sorts the tets and nodes of a model by their role in a solve: which tets deform, and which nodes are held by bones.
#pragma once

#include <vector>

#include "core/fem/solve_pose.h"

namespace limber {

// The mesh's tets that deform and its rigid tets; the nodes that bones hold by springs (pinned), and the nodes that
// move exactly with a bone (carried). A tet whose nodes are all held by one bone is rigid, unless it shares a node with
// flesh, because that node may yield.
struct SolvedParts {
  Eigen::MatrixX4i elastic, rigid;
  std::vector<Eigen::Index> elastic_tet;  // index in the mesh of each elastic tet
  std::vector<TetMaterial> material;      // material of each elastic tet
  std::vector<char> is_flesh;             // 1 for each elastic tet whose nodes are not all held by one bone
  // Held nodes of elastic tets, on springs; held nodes of rigid tets only, moved exactly.
  std::vector<int> pinned, carried;
  std::vector<double> pin_stiffness;
  std::vector<char> in_joint;  // #V: 1 for nodes of tets between two bones

  SolvedParts() = default;
  // Sorts the tets and nodes of the model by the bones that currently hold them.
  //   held_by  #V: the bone that currently holds each node, -1: free
  //   size     size of the body relative to an adult (1); spring stiffness is divided by its square
  SolvedParts(const FemModel& model, const std::vector<int>& held_by, double size);
};

// Throws Error if the model's lists do not fit its mesh, or if a tet is inverted at rest or at the start.
//   start  #V positions; null: rest
void check(const FemModel& model, const Eigen::MatrixX3d* start);

// Returns the nodes that become free only at a later position on the path, with that position. A small group of nodes
// becomes free together with the group before it, since each group costs a new analysis of the matrix.
std::vector<FemModel::Waiting> worth_waiting(const FemModel& model);

// Returns the energy of the model's sliding nodes, with the bones at rest.
SlideForm slide_form_of(const FemModel& model, const SolveSettings& settings);

}  // namespace limber
