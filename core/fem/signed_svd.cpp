// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/signed_svd.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "core/fem/matrix_lanes.h"

namespace limber {

namespace {

template <class Lanes>
LIMBER_INLINE void take_root(typename Lanes::Numbers& of) {
  for (int l = 0; l < Lanes::kCount; ++l) of[l] = std::sqrt(of[l]);
}

template <class N>
LIMBER_INLINE N dot(const N* a, const N* b) {
  return a[0] * b[0] + (a[1] * b[1] + a[2] * b[2]);
}

// Rotates the columns of B = F V until they are perpendicular to each other, and sorts them by descending length.
// Writes their squared lengths to `squared`.
template <class Lanes>
LIMBER_INLINE void rotate(typename Lanes::Numbers B[3][3], typename Lanes::Numbers V[3][3],
                          typename Lanes::Numbers squared[3]) {
  using N = typename Lanes::Numbers;
  constexpr double kPerpendicular = 1e-15;
  constexpr std::array<std::pair<int, int>, 3> kPairs{{{0, 1}, {0, 2}, {1, 2}}}, kFalling{{{0, 1}, {1, 2}, {0, 1}}};
  const N one = N{} + 1.0, none{};
  for (int sweep = 0; sweep < 12; ++sweep) {
    bool turned = false;
    for (const auto& [i, j] : kPairs) {
      const N ii = dot(B[i], B[i]), jj = dot(B[j], B[j]), ij = dot(B[i], B[j]);
      const auto turns = ij * ij > kPerpendicular * kPerpendicular * ii * jj;
      bool any = false;
      for (int l = 0; l < Lanes::kCount; ++l) any |= turns[l] != 0;
      if (!any) continue;
      turned = true;
      const N half = (jj - ii) / (2.0 * (turns ? ij : one));
      N hypotenuse = one + half * half;
      take_root<Lanes>(hypotenuse);
      const N t = (half >= 0.0 ? one : -one) / ((half >= 0.0 ? half : -half) + hypotenuse);
      N length = one + t * t;
      take_root<Lanes>(length);
      const N cosine = one / length, c = turns ? cosine : one, s = turns ? cosine * t : none;
      for (auto* M : {B, V})
        for (int k = 0; k < 3; ++k) {
          const N a = M[i][k], b = M[j][k];
          M[i][k] = c * a - s * b;
          M[j][k] = s * a + c * b;
        }
    }
    if (!turned) break;
  }
  // Sorts the columns by swaps. Each swap changes the sign of one column, so that V stays a rotation.
  for (int i = 0; i < 3; ++i) squared[i] = dot(B[i], B[i]);
  for (const auto& [i, j] : kFalling) {
    const auto stays = squared[i] >= squared[j];
    const N larger = stays ? squared[i] : squared[j];
    squared[j] = stays ? squared[j] : squared[i];
    squared[i] = larger;
    for (auto* M : {B, V})
      for (int k = 0; k < 3; ++k) {
        const N a = M[i][k], b = M[j][k];
        M[i][k] = stays ? a : b;
        M[j][k] = stays ? b : -a;
      }
  }
}

LIMBER_INLINE void finish(const Eigen::Matrix3d& B, double longest_squared, double middle_squared, Principal& p) {
  p.sigma[0] = std::sqrt(longest_squared);
  p.sigma[1] = std::sqrt(middle_squared);
  p.U.col(0) = p.sigma[0] > 0 ? Eigen::Vector3d(B.col(0) / p.sigma[0]) : Eigen::Vector3d::UnitX();
  p.U.col(1) = p.sigma[1] > 1e-150 ? Eigen::Vector3d(B.col(1) / p.sigma[1]) : p.U.col(0).unitOrthogonal();
  p.U.col(2) = p.U.col(0).cross(p.U.col(1));
  p.sigma[2] = p.U.col(2).dot(B.col(2));
}

// Decomposes `count` (at most kCount) matrices that start at `F`, one per lane. Unused lanes repeat the first matrix.
template <class Lanes>
LIMBER_INLINE void decompose(const Eigen::Matrix3d* F, Principal* result, std::size_t count) {
  typename Lanes::Numbers B[3][3], V[3][3], squared[3];
  for (int j = 0; j < 3; ++j)
    for (int k = 0; k < 3; ++k) {
      for (int l = 0; l < Lanes::kCount; ++l) B[j][k][l] = F[std::size_t(l) < count ? l : 0](k, j);
      V[j][k] = typename Lanes::Numbers{} + (j == k ? 1.0 : 0.0);
    }
  rotate<Lanes>(B, V, squared);
  for (int l = 0; l < int(std::min<std::size_t>(Lanes::kCount, count)); ++l) {
    Eigen::Matrix3d columns;
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) columns(k, j) = B[j][k][l], result[l].V(k, j) = V[j][k][l];
    finish(columns, squared[0][l], squared[1][l], result[l]);
  }
}

template <class Lanes>
LIMBER_INLINE void decompose_all(const Eigen::Matrix3d* F, Principal* result, std::size_t count) {
  for (std::size_t k = 0; k < count; k += Lanes::kCount) decompose<Lanes>(F + k, result + k, count - k);
}

LIMBER_FOR_FOUR void all_by_four(const Eigen::Matrix3d* F, Principal* result, std::size_t count) {
  decompose_all<FourLanes>(F, result, count);
}
void all_by_two(const Eigen::Matrix3d* F, Principal* result, std::size_t count) {
  decompose_all<TwoLanes>(F, result, count);
}

}  // namespace

void signed_svd(std::span<const Eigen::Matrix3d> F, std::span<Principal> result, MatrixLanes width) {
  assert(F.size() == result.size());
  (takes_four(width) ? all_by_four : all_by_two)(F.data(), result.data(), F.size());
}

Principal signed_svd(const Eigen::Matrix3d& F) {
  Principal result;
  signed_svd({&F, 1}, {&result, 1});
  return result;
}

}  // namespace limber
