// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/air_form.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "core/fem/step_bound.h"

namespace limber {

namespace {
constexpr double kRigidStrain = 0.001;   // |F^T F - 1| up to which air counts as moving rigidly; with 0.01 skin slipped through it
constexpr double kNoVolume = 1e-12;      // mm3, six times the volume

using Edges = Eigen::Matrix3d;

Edges edges(const Places& x, const Eigen::RowVector4i& tet) {
  Edges D;
  for (int a = 0; a < 3; ++a) D.col(a) = (x.row(tet[a + 1]) - x.row(tet[0])).transpose();
  return D;
}

// Least distance of a corner from the face across.
double height(const Edges& D) {
  const Eigen::Vector3d a = D.col(0), b = D.col(1), c = D.col(2);
  const double largest = std::max({a.cross(b).norm(), b.cross(c).norm(), c.cross(a).norm(), (b - a).cross(c - a).norm()});
  return D.determinant() / largest;
}
}  // namespace

Eigen::MatrixX4i moving_air(const Eigen::MatrixX4i& air, const Places& x, const Places& next) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < air.rows(); ++t) {
    const Edges now = edges(x, air.row(t));
    if (!(now.determinant() > kNoVolume)) continue;
    const Eigen::Matrix3d F = edges(next, air.row(t)) * now.inverse();
    if ((F.transpose() * F - Eigen::Matrix3d::Identity()).norm() > kRigidStrain) kept.push_back(t);
  }
  return air(kept, Eigen::all);
}

ElasticForm air_form(const Eigen::MatrixX4i& T, const Places& x, const AirSettings& settings) {
  std::vector<TetEnergy> energy(T.rows());
  for (Eigen::Index t = 0; t < T.rows(); ++t) {
    const double thin = std::max(height(edges(x, T.row(t))), settings.thinnest_mm);
    energy[t] = {settings.shear_kpa, 0, settings.barrier_kpa, std::max(settings.share, settings.thickness_mm / thin)};
  }
  return ElasticForm(x, T, energy);
}

}  // namespace limber
