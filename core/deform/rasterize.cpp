// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/rasterize.h"

#include <cmath>

namespace limber {

namespace {

// Indices of the corners of a cube's five tets, positively oriented: first the central tet, then each tet that is cut
// off at a corner; the cut-off corner comes first. Row 0 is for cubes whose lowest corner has an even sum of
// coordinates.
constexpr int kTetCorners[2][5][4] = {
    {{0, 5, 3, 6}, {1, 0, 5, 3}, {2, 3, 6, 0}, {4, 5, 0, 6}, {7, 6, 3, 5}},
    {{7, 4, 2, 1}, {0, 1, 2, 4}, {3, 2, 1, 7}, {5, 4, 7, 1}, {6, 7, 4, 2}},
};

constexpr double kRounding = 1e-9;  // allowance for rounding errors of a position in a cube, half edges of the cube

int parity(const glm::ivec3& v) { return (v.x + v.y + v.z) & 1; }

glm::dvec3 corner_sign(int corner) { return {corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1}; }

double largest_row_sum(const glm::dmat3& m) {
  double largest = 0;
  for (int row = 0; row < 3; ++row)
    largest = std::max(largest, std::abs(m[0][row]) + std::abs(m[1][row]) + std::abs(m[2][row]));
  return largest;
}

// If a cube's extent in fixed point exceeds this limit (1024 voxels), the cube is rasterized tet by tet, since the sum
// of eight corners must fit an int.
constexpr int kLargestExtent = 1 << 26;

// Returns 8 times the eight coefficients of a cube's trilinear map, from its corners (a Hadamard transform). Bits 0, 1,
// 2 of a coefficient's index say whether it multiplies x, y, z.
std::array<Lanes, 8> trilinear_coefficients(std::array<Lanes, 8> c) {
  for (int bit : {1, 2, 4})
    for (int i = 0; i < 8; ++i)
      if (!(i & bit)) {
        const Lanes low = c[i], high = c[i | bit];
        c[i] = high + low;
        c[i | bit] = high - low;
      }
  return c;
}

glm::dvec3 voxels_of(const Lanes& c) { return glm::dvec3(c[0], c[1], c[2]) / (8.0 * kFixedOne); }

int largest(const Lanes& c) { return std::max({std::abs(c[0]), std::abs(c[1]), std::abs(c[2])}); }

}  // namespace

CellClaim claim_in_tet(const std::array<FixedPoint, 4>& posed, const std::array<glm::dvec3, 4>& rest,
                       const glm::ivec3& voxel) {
  const glm::dvec3 from = glm::dvec3(posed[0]) / double(kFixedOne);
  glm::dmat3 posed_edges, rest_edges;
  for (int i = 0; i < 3; ++i) {
    posed_edges[i] = glm::dvec3(posed[i + 1]) / double(kFixedOne) - from;
    rest_edges[i] = rest[i + 1] - rest[0];
  }
  const glm::dvec3 faces[] = {glm::cross(posed_edges[1], posed_edges[2]), glm::cross(posed_edges[2], posed_edges[0]),
                              glm::cross(posed_edges[0], posed_edges[1])};
  const double determinant = glm::dot(posed_edges[0], faces[0]);
  const glm::dvec3 p = glm::dvec3(voxel) - from;
  const glm::dvec3 share =
      glm::dvec3(glm::dot(faces[0], p), glm::dot(faces[1], p), glm::dot(faces[2], p)) / determinant;
  return {voxel, rest[0] + rest_edges * share, determinant / glm::determinant(rest_edges)};
}

PosedCell::Inverse PosedCell::affine_inverse() const {
  Inverse inverse;
  for (int axis = 0; axis < 3; ++axis)
    if (std::int64_t{box_.high[axis]} - box_.low[axis] >= kLargestExtent / kFixedOne) return inverse;
  std::array<Lanes, 8> from_first;
  const Lanes first = lanes_of_two(lowest_)[0];
  for (int i = 0; i < 8; i += 2) {
    const auto [even, odd] = lanes_of_two(&corner(i));
    from_first[i] = even - first;
    from_first[i + 1] = odd - first;
  }
  const auto c = trilinear_coefficients(from_first);
  const glm::dvec3 x = voxels_of(c[1]), y = voxels_of(c[2]), z = voxels_of(c[4]);  // half of its mean edges
  const glm::dmat3 faces(glm::cross(y, z), glm::cross(z, x), glm::cross(x, y));
  const double determinant = glm::dot(x, faces[0]);
  if (!(determinant > 1e-6)) return inverse;
  inverse.place_from_posed = glm::transpose(faces) * (1 / determinant);
  inverse.middle = glm::dvec3(corner(0)) / double(kFixedOne) + voxels_of(c[0]);
  inverse.posed_per_rest = 8 * determinant;
  const double departure = (largest(c[3]) + largest(c[5]) + largest(c[6]) + largest(c[7])) / (8.0 * kFixedOne);
  inverse.slack = largest_row_sum(inverse.place_from_posed) * departure + kRounding;
  return inverse;
}

int PosedCell::find_tet(const glm::ivec3& voxel, const glm::dvec3& place, double slack) const {
  int found = 0;
  for (int t = 1; t < kTets; ++t) {
    const double beyond = glm::dot(corner_sign(kTetCorners[parity(rest_voxel_)][t][0]), place) - 1;
    if (std::abs(beyond) < 3 * slack) return find_tet_exactly(voxel);
    if (beyond > 0) found = t;
  }
  return found;
}

template <class Whole>
int PosedCell::first_tet_with(const glm::ivec3& voxel) const {
  for (int t = 0; t < kTets; ++t)
    if (TetFaces<Whole>(posed_tet(t)).contains(voxel)) return t;
  return -1;
}

int PosedCell::find_tet_exactly(const glm::ivec3& voxel) const {
  const glm::ivec3 size = box_.high - box_.low;  // smaller than the cube's extent by up to two voxels
  const bool is_small = std::max({size.x, size.y, size.z}) + 2 <= kSmallExtent && box_.contains(voxel);
  return is_small ? first_tet_with<std::int64_t>(voxel) : first_tet_with<__int128>(voxel);
}

std::array<FixedPoint, 4> PosedCell::posed_tet(int t) const {
  const auto& c = kTetCorners[parity(rest_voxel_)][t];
  return {corner(c[0]), corner(c[1]), corner(c[2]), corner(c[3])};
}

CellClaim PosedCell::claim_in(int t, const glm::ivec3& voxel) const {
  std::array<glm::dvec3, 4> rest;
  for (int i = 0; i < 4; ++i)
    rest[i] = glm::dvec3(rest_voxel_) + 0.5 * corner_sign(kTetCorners[parity(rest_voxel_)][t][i]);
  return claim_in_tet(posed_tet(t), rest, voxel);
}

}  // namespace limber
