// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/tet_derivatives.h"

#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <doctest/doctest.h>

using namespace limber;

namespace {
struct RandomTets {
  std::vector<std::array<Eigen::Vector3d, 4>> slopes;
  std::vector<Principal> axes;
  std::vector<TetState> states;

  RandomTets(int count, unsigned seed) : slopes(count), axes(count), states(count) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int t = 0; t < count; ++t) {
      for (int a = 1; a < 4; ++a) slopes[t][a] = Eigen::Vector3d::NullaryExpr([&] { return uniform(random); });
      slopes[t][0] = -(slopes[t][1] + slopes[t][2] + slopes[t][3]);
      TetState& state = states[t];
      state.slopes = &slopes[t];
      state.F = Eigen::Matrix3d::Identity() + 0.8 * Eigen::Matrix3d::NullaryExpr([&] { return uniform(random); });
      state.volume = 1.5 + uniform(random);
      state.shear = 2 + uniform(random);
      state.force_slope = 3 * uniform(random);
      state.slope = 4 * uniform(random);
      state.curvature = 5 * uniform(random);
      axes[t] = signed_svd(state.F);
      state.axes = &axes[t];
      if (t % 3) state.negative = negative_curvature(state.shear, state.slope, state.curvature, axes[t].sigma);
    }
  }
};

// Returns the block of the Hessian between nodes a and b. The second derivative of the energy density in the directions
// A and B is shear A:B + curvature (C:A)(C:B) + slope (dC:A). C is the cofactor matrix of F, the derivative of det F;
// dC is the change of C along B.
Eigen::Matrix3d block(const TetState& tet, int a, int b) {
  const auto cofactor = [](const Eigen::Matrix3d& F) {
    Eigen::Matrix3d C;
    C << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
    return C;
  };
  Eigen::Matrix3d H;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Eigen::Matrix3d A = Eigen::Vector3d::Unit(i) * (*tet.slopes)[a].transpose(),
                            B = Eigen::Vector3d::Unit(j) * (*tet.slopes)[b].transpose();
      const auto along = [](const Eigen::Matrix3d& P, const Eigen::Matrix3d& Q) { return P.cwiseProduct(Q).sum(); };
      const Eigen::Matrix3d C = cofactor(tet.F);
      // The cofactors are quadratic in F, so a central difference gives their exact derivative along B.
      const Eigen::Matrix3d dC = 0.5 * (cofactor(tet.F + B) - cofactor(tet.F - B));
      double value = tet.shear * along(A, B) + tet.curvature * along(C, A) * along(C, B) + tet.slope * along(dC, A);
      for (int k = 0; k < tet.negative.count; ++k) {
        const Eigen::Matrix3d Q = tet.axes->U * tet.negative.direction[k].mode * tet.axes->V.transpose();
        value += tet.negative.direction[k].value * along(Q, A) * along(Q, B);
      }
      H(i, j) = tet.volume * value;
    }
  return H;
}
}  // namespace

TEST_CASE("tet derivatives: blocks and forces are those of the energy, written out") {
  const RandomTets tets(40, 1);
  int negative = 0;
  for (std::size_t t = 0; t + 4 <= tets.states.size(); t += 4) {
    TetDerivatives result;
    tet_derivatives({&tets.states[t], 4}, result);
    for (int l = 0; l < 4; ++l) {
      const TetState& tet = tets.states[t + l];
      negative += tet.negative.count;
      for (int a = 0, pair = 0; a < 4; ++a) {
        Eigen::Matrix3d C;
        C << tet.F.col(1).cross(tet.F.col(2)), tet.F.col(2).cross(tet.F.col(0)), tet.F.col(0).cross(tet.F.col(1));
        const Eigen::Vector3d force = tet.volume * (tet.shear * tet.F + tet.force_slope * C) * (*tet.slopes)[a];
        for (int k = 0; k < 3; ++k) CHECK(result.force[a][k][l] == doctest::Approx(force[k]).epsilon(1e-12));
        for (int b = 0; b <= a; ++b, ++pair) {
          Eigen::Matrix3d H;
          for (int c = 0; c < 3; ++c)
            for (int r = 0; r < 3; ++r) H(r, c) = result.block[pair][c][r][l];
          const Eigen::Matrix3d expected = block(tet, a, b);
          CHECK((H - expected).norm() < 1e-12 * (1 + expected.norm()));
        }
      }
    }
  }
  CHECK(negative > 20);
}

TEST_CASE("tet derivatives: two lanes and four come out the same, however many tets there are") {
  const RandomTets tets(4, 2);
  for (const std::size_t count : {1, 2, 3, 4}) {
    TetDerivatives wide, narrow;
    tet_derivatives({tets.states.data(), count}, wide);
    tet_derivatives({tets.states.data(), count}, narrow, MatrixLanes::Two);
    for (std::size_t l = 0; l < count; ++l) {
      for (int a = 0; a < 4; ++a)
        for (int k = 0; k < 3; ++k) CHECK(wide.force[a][k][l] == narrow.force[a][k][l]);
      for (int pair = 0; pair < 10; ++pair)
        for (int c = 0; c < 3; ++c)
          for (int r = 0; r < 3; ++r) CHECK(wide.block[pair][c][r][l] == narrow.block[pair][c][r][l]);
    }
  }
}
