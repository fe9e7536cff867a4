// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/signed_svd.h"

#include <random>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <doctest/doctest.h>

using namespace limber;

TEST_CASE("principal: singular values are exact, falling, and only the last is negative where the tet is inverted") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int k = 0; k < 200; ++k) {
    Eigen::Matrix3d F = Eigen::Matrix3d::NullaryExpr([&] { return uniform(random); });
    if (k % 4 == 1) F.col(2) = F.col(0) + 1e-9 * F.col(2);
    if (k % 4 == 2) F = Eigen::Quaterniond(1, uniform(random), uniform(random), 0).normalized().toRotationMatrix();
    const Principal p = signed_svd(F);
    CHECK((p.U * p.sigma.asDiagonal() * p.V.transpose() - F).norm() < 1e-14);
    CHECK((p.U.transpose() * p.U - Eigen::Matrix3d::Identity()).norm() < 1e-13);
    CHECK((p.V.transpose() * p.V - Eigen::Matrix3d::Identity()).norm() < 1e-13);
    CHECK(p.U.determinant() == doctest::Approx(1));
    CHECK(p.V.determinant() == doctest::Approx(1));
    CHECK(p.sigma[0] >= p.sigma[1]);
    CHECK(p.sigma[1] >= std::abs(p.sigma[2]) - 1e-15);
    CHECK(p.sigma.prod() == doctest::Approx(F.determinant()));
  }
}

TEST_CASE("principal: two at once, four at once and one by one come out the same, however many there are") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const std::size_t count : {0, 1, 2, 3, 4, 5, 49}) {
    std::vector<Eigen::Matrix3d> F(count);
    for (auto& each : F) each = Eigen::Matrix3d::NullaryExpr([&] { return uniform(random); });
    if (count > 2) F[1].setIdentity(), F[2].setZero();
    std::vector<Principal> wide(count), narrow(count);
    signed_svd(F, wide);
    signed_svd(F, narrow, MatrixLanes::Two);
    for (std::size_t k = 0; k < count; ++k) {
      const Principal one = signed_svd(F[k]);
      for (const Principal* other : {std::as_const(narrow).data() + k, &one}) {
        CHECK(wide[k].U == other->U);
        CHECK(wide[k].V == other->V);
        CHECK(wide[k].sigma == other->sigma);
      }
    }
  }
}
