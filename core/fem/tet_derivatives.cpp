// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/tet_derivatives.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "core/fem/matrix_lanes.h"

namespace limber {

namespace {

template <class N>
LIMBER_INLINE N dot(const N* a, const N* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class N>
LIMBER_INLINE void cross(const N* a, const N* b, N* product) {
  for (int k = 0; k < 3; ++k) product[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

// Computes the product of a matrix, given by its columns, and the vector v.
template <class N>
LIMBER_INLINE void multiply(const N columns[3][3], const N* v, N* product) {
  for (int k = 0; k < 3; ++k) product[k] = columns[0][k] * v[0] + columns[1][k] * v[1] + columns[2][k] * v[2];
}

// Computes the derivatives of consecutive tets, from index `first` on, one tet per SIMD lane. Lanes beyond the last tet
// repeat the last tet.
template <class Lanes>
LIMBER_INLINE void derive(std::span<const TetState> tets, int first, TetDerivatives& result) {
  using N = typename Lanes::Numbers;
  const TetState* state[Lanes::kCount];
  for (int l = 0; l < Lanes::kCount; ++l) state[l] = &tets[std::min<std::size_t>(first + l, tets.size() - 1)];

  // One value per tet: F by columns, the gradients s of the nodes, and the other numbers, multiplied by the volume.
  N F[3][3], s[4][3], volume, shear, force_slope, g, h;
  int negative = 0;
  for (int l = 0; l < Lanes::kCount; ++l) {
    const TetState& tet = *state[l];
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) F[j][k][l] = tet.F(k, j);
    for (int a = 0; a < 4; ++a)
      for (int k = 0; k < 3; ++k) s[a][k][l] = (*tet.slopes)[a][k];
    volume[l] = tet.volume;
    shear[l] = tet.volume * tet.shear;
    force_slope[l] = tet.volume * tet.force_slope;
    g[l] = tet.volume * tet.slope;
    h[l] = tet.volume * tet.curvature;
    negative = std::max(negative, tet.negative.count);
  }

  N C[3][3], P[3][3], c[4][3], hc[4][3], force[4][3];
  for (int j = 0; j < 3; ++j) cross(F[(j + 1) % 3], F[(j + 2) % 3], C[j]);
  for (int j = 0; j < 3; ++j)
    for (int k = 0; k < 3; ++k) P[j][k] = shear * F[j][k] + force_slope * C[j][k];
  for (int a = 0; a < 4; ++a) {
    multiply(P, s[a], force[a]);
    multiply(C, s[a], c[a]);
    for (int k = 0; k < 3; ++k) {
      hc[a][k] = h * c[a][k];
      std::memcpy(&result.force[a][k][first], &force[a][k], sizeof(N));
    }
  }

  N H[10][3][3];
  for (int a = 0, pair = 0; a < 4; ++a)
    for (int b = 0; b <= a; ++b, ++pair) {
      const N along = shear * dot(s[a], s[b]);
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) H[pair][j][k] = hc[a][k] * c[b][j];
      for (int k = 0; k < 3; ++k) H[pair][k][k] += along;
      if (a == b) continue;
      N normal[3], w[3];
      cross(s[a], s[b], normal);
      multiply(F, normal, w);
      for (int k = 0; k < 3; ++k) {
        const N gw = g * w[k];
        H[pair][(k + 2) % 3][(k + 1) % 3] += gw;
        H[pair][(k + 1) % 3][(k + 2) % 3] -= gw;
      }
    }

  for (int d = 0; d < negative; ++d) {
    N Q[3][3], weight = {};
    for (int l = 0; l < Lanes::kCount; ++l) {
      const NegativeCurvature& of = state[l]->negative;
      if (d >= of.count) {
        for (int j = 0; j < 3; ++j)
          for (int k = 0; k < 3; ++k) Q[j][k][l] = 0;
        continue;
      }
      const Eigen::Matrix3d direction = state[l]->axes->U * of.direction[d].mode * state[l]->axes->V.transpose();
      weight[l] = of.direction[d].value;
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) Q[j][k][l] = direction(k, j);
    }
    weight *= volume;
    N q[4][3];
    for (int a = 0; a < 4; ++a) multiply(Q, s[a], q[a]);
    for (int a = 0, pair = 0; a < 4; ++a) {
      const N scaled[3] = {weight * q[a][0], weight * q[a][1], weight * q[a][2]};
      for (int b = 0; b <= a; ++b, ++pair)
        for (int j = 0; j < 3; ++j)
          for (int k = 0; k < 3; ++k) H[pair][j][k] += scaled[k] * q[b][j];
    }
  }
  for (int pair = 0; pair < 10; ++pair)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) std::memcpy(&result.block[pair][j][k][first], &H[pair][j][k], sizeof(N));
}

LIMBER_FOR_FOUR void derive_four(std::span<const TetState> tets, TetDerivatives& result) {
  derive<FourLanes>(tets, 0, result);
}
void derive_two_and_two(std::span<const TetState> tets, TetDerivatives& result) {
  derive<TwoLanes>(tets, 0, result);
  if (tets.size() > 2) derive<TwoLanes>(tets, 2, result);
}

}  // namespace

void tet_derivatives(std::span<const TetState> tets, TetDerivatives& result, MatrixLanes width) {
  static_assert(FourLanes::kCount == TetDerivatives::kTets);
  assert(!tets.empty() && tets.size() <= TetDerivatives::kTets);
  (takes_four(width) ? derive_four : derive_two_and_two)(tets, result);
}

}  // namespace limber
