// SPDX-License-Identifier: AGPL-3.0-or-later
// The energy of one tet by its deformation gradient F, its stress and its curvature:
//   W(F) = mu/2 (|F|^2 - 3) - mu ln J + k/2 (J - 1)^2 + c h b(J / h),   b(t) = -(t - 1)^2 ln t below 1, else 0
// The last term is a barrier against J = 0 that begins at J = h and is smooth there [Li et al. 2020, Incremental
// Potential Contact]; c in kPa is how hard it pushes. A pressure p (of a patch, patch_form.h) adds p (J - 1).
//
// All of it depends on |F|^2 and J only, so with the singular values s of F the curvature falls apart into a 3x3 block
// of stretches and, for each pair of axes, a shear mu - g s and a turn mu + g s, g = dW/dJ and s the third singular
// value [Smith, de Goes & Kim 2019]. The projected curvature leaves out what is negative of these: nearest, and never
// indefinite.
#pragma once

#include <Eigen/Core>

namespace limber {

struct TetEnergy {
  double shear = 1;          // mu, kPa
  double bulk = 0;           // k, kPa
  double barrier = 0;        // c, kPa
  double barrier_below = 1;  // h, of J
};

// Of what depends on J alone.
struct VolumeTerm {
  double value, slope, curvature;
};
VolumeTerm volume_term(const TetEnergy& energy, double J);

double energy_density(const TetEnergy& energy, const Eigen::Matrix3d& F, double J);

// Directions in which the curvature of W is negative: curvature -value along the unit matrix U mode V^T.
struct NegativeCurvature {
  struct Direction {
    double value;          // above 0
    Eigen::Matrix3d mode;  // in principal axes
  };
  int count = 0;
  Direction direction[9];
};
// slope, curvature  of the volume term, the pressure included
NegativeCurvature negative_curvature(double shear, double slope, double curvature, const Eigen::Vector3d& sigma);

}  // namespace limber
