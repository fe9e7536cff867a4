// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/tet_energy.h"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace limber {

VolumeTerm volume_term(const TetEnergy& e, double J) {
  const double ln = std::log(J);
  VolumeTerm term{-e.shear * ln + 0.5 * e.bulk * (J - 1) * (J - 1), -e.shear / J + e.bulk * (J - 1),
                  e.shear / (J * J) + e.bulk};
  if (e.barrier > 0 && J < e.barrier_below) {
    const double t = J / e.barrier_below, d = t - 1, ln_t = std::log(t);
    term.value -= e.barrier * e.barrier_below * d * d * ln_t;
    term.slope -= e.barrier * d * (2 * ln_t + d / t);
    term.curvature += e.barrier / e.barrier_below * (-2 * ln_t - 4 * d / t + d * d / (t * t));
  }
  return term;
}

double energy_density(const TetEnergy& e, const Eigen::Matrix3d& F, double J) {
  return 0.5 * e.shear * (F.squaredNorm() - 3) + volume_term(e, J).value;
}

NegativeCurvature negative_curvature(double shear, double g, double h, const Eigen::Vector3d& s) {
  NegativeCurvature negative;
  const double half = std::sqrt(0.5);
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    for (const double sign : {1.0, -1.0}) {
      const double value = shear - sign * g * s[k];
      if (value >= 0) continue;
      auto& direction = negative.direction[negative.count++];
      direction.value = -value;
      direction.mode.setZero();
      direction.mode(i, j) = half;
      direction.mode(j, i) = sign * half;
    }
  }

  const Eigen::Vector3d a(s[1] * s[2], s[0] * s[2], s[0] * s[1]);
  Eigen::Matrix3d A = h * a * a.transpose();
  A.diagonal().array() += shear;
  A(0, 1) = A(1, 0) = A(0, 1) + g * s[2];
  A(0, 2) = A(2, 0) = A(0, 2) + g * s[1];
  A(1, 2) = A(2, 1) = A(1, 2) + g * s[0];
  const double minor = A(0, 0) * A(1, 1) - A(0, 1) * A(0, 1);
  if (A(0, 0) > 0 && minor > 0 && A.determinant() > 0) return negative;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> stretches(A);
  for (int k = 0; k < 3; ++k)
    if (stretches.eigenvalues()[k] < 0)
      negative.direction[negative.count++] = {-stretches.eigenvalues()[k],
                                              stretches.eigenvectors().col(k).asDiagonal()};
  return negative;
}

}  // namespace limber
