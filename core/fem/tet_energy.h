// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the energy density of one tet from its deformation gradient F, and the directions in which its Hessian is
// negative:
//   W(F) = mu/2 (|F|^2 - 3) - mu ln J + k/2 (J - 1)^2 + c h b(J / h),   b(t) = -(t - 1)^2 ln t for t < 1, else 0
// with J = det F. The last term is a barrier against J = 0 that begins at J = h and is smooth there [Li et al. 2020,
// Incremental Potential Contact]; c in kPa is its strength. A pressure p (of a patch, patch_form.h) adds p (J - 1).
//
// All terms depend on |F|^2 and J only. In the axes of the singular values of F, the Hessian therefore splits into a
// 3x3 block of stretches and, for each pair of axes, the eigenvalue mu - g s of a shear and the eigenvalue mu + g s of
// a rotation. Here g = dW/dJ, and s is the singular value of the third axis [Smith, de Goes & Kim 2019]. The projected
// Hessian leaves out the negative eigenvalues; it is the nearest positive semidefinite matrix.
#pragma once

#include <Eigen/Core>

namespace limber {

struct TetEnergy {
  double shear = 1;          // shear modulus mu, kPa
  double bulk = 0;           // bulk modulus k, kPa
  double barrier = 0;        // strength c of the barrier, kPa
  double barrier_below = 1;  // h: the barrier acts if J is below it
};

// The terms of the energy that depend on J only: their value, and their first and second derivative by J.
struct VolumeTerm {
  double value, slope, curvature;
};
VolumeTerm volume_term(const TetEnergy& energy, double J);

double energy_density(const TetEnergy& energy, const Eigen::Matrix3d& F, double J);

// The directions in which the Hessian of W has a negative eigenvalue, -value. The direction is the unit matrix U mode
// V^T, with F = U diag(sigma) V^T.
struct NegativeCurvature {
  struct Direction {
    double value;          // minus the negative eigenvalue, so above 0
    Eigen::Matrix3d mode;  // the direction as a matrix with unit norm, in the principal axes of F
  };
  int count = 0;
  Direction direction[9];
};
//   slope, curvature  first and second derivative of the volume term by J
//   sigma             singular values of F
NegativeCurvature negative_curvature(double shear, double slope, double curvature, const Eigen::Vector3d& sigma);

}  // namespace limber
