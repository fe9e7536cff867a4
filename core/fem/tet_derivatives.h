// SPDX-License-Identifier: AGPL-3.0-or-later
// Forces and curvature of tets by the places of their nodes, four tets at a time (matrix_lanes.h): half of what
// assembling a matrix took went there. With s_a the slope of node a's hat function, C the cofactors of F, c_a = C s_a,
// and g and h the slope and curvature of the volume term (tet_energy.h), the block between nodes a and b is, times the
// tet's volume,
//   mu (s_a . s_b) I + h c_a c_b^T - g [F (s_a x s_b)]_x   and for each direction Q left out of it   + value (Q s_a) (Q
//   s_b)^T
#pragma once

#include <array>
#include <span>

#include <Eigen/Core>

#include "core/fem/signed_svd.h"
#include "core/fem/tet_energy.h"

namespace limber {

struct TetState {
  const std::array<Eigen::Vector3d, 4>* slopes;  // of the nodes' hat functions at rest, 1/mm
  Eigen::Matrix3d F;
  double volume, shear;             // mm3, kPa
  double force_slope;               // of what depends on J, for the forces,
  double slope, curvature;          // and for the curvature
  const Principal* axes = nullptr;  // of F, where there is anything negative
  NegativeCurvature negative;       // left out
};

// Of tet l at [...][l].
struct TetDerivatives {
  static constexpr int kTets = 4;
  double force[4][3][kTets];      // by node and axis: of the energy by the node's place
  double block[10][3][3][kTets];  // by pair of nodes a >= b (lower triangle, row by row), column, row
};

// tets  at most kTets
void tet_derivatives(std::span<const TetState> tets, TetDerivatives& result, MatrixLanes width = MatrixLanes::Widest);

}  // namespace limber
