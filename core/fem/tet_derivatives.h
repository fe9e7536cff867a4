// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the gradient and the Hessian of tets' energies with respect to the nodes' positions, four tets at a time
// (matrix_lanes.h), since one at a time this would take half of the time for assembling a matrix. Let s_a be the
// gradient of node a's shape function, C the cofactor matrix of F, c_a = C s_a, and g and h the first and second
// derivative of the volume term (tet_energy.h). Then the Hessian's block between nodes a and b is the tet's volume
// times
//   mu (s_a . s_b) I + h c_a c_b^T - g [F (s_a x s_b)]_x,
// where [v]_x is the matrix of the cross product with v. To remove negative curvature, the tet's volume times
//   value (Q s_a) (Q s_b)^T
// is added for each direction Q in which the energy's second derivative is -value < 0 (NegativeCurvature).
#pragma once

#include <array>
#include <span>

#include <Eigen/Core>

#include "core/fem/signed_svd.h"
#include "core/fem/tet_energy.h"

namespace limber {

struct TetState {
  const std::array<Eigen::Vector3d, 4>* slopes;  // gradients of the nodes' shape functions at rest, 1/mm
  Eigen::Matrix3d F;
  double volume, shear;             // volume at rest, mm3; shear modulus, kPa
  double force_slope;               // first derivative of the volume term (with pressure) by J, for the gradient
  double slope, curvature;          // first and second derivative of the volume term by J, for the Hessian
  const Principal* axes = nullptr;  // singular value decomposition of F; only needed if there is negative curvature
  NegativeCurvature negative;       // negative curvature to leave out of the Hessian
};

// The derivatives of up to kTets tets. The last index of each array is the tet.
struct TetDerivatives {
  static constexpr int kTets = 4;
  double force[4][3][kTets];      // [node][axis][tet]: derivative of the energy by the node's position
  double block[10][3][3][kTets];  // [pair][column][row][tet]: pairs of nodes a >= b (lower triangle, row by row)
};

// Computes the derivatives of the energy of each tet.
//   tets  at least one, at most kTets
void tet_derivatives(std::span<const TetState> tets, TetDerivatives& result, MatrixLanes width = MatrixLanes::Widest);

}  // namespace limber
