// SPDX-License-Identifier: AGPL-3.0-or-later
// Which voxel centres lie in a posed cell, and which rest point each of them is the image of.
//
// A cube is split into five tets: one on the four corners whose coordinates add up to an even number, four cut off at the
// odd corners. Neighbouring cubes are mirror images, so their diagonals meet. (The split into six tets around a main
// diagonal puts every voxel centre of the rest pose on an edge of all six; here it lies in the middle of one.)
//
// Every voxel centre covered by a mesh of such cells is claimed by exactly one tet, always: vertices are whole numbers
// of 1/65536 voxel, so the side of a face a centre lies on is computed exactly, and a centre *on* a face counts as
// moved by (d, d^2, d^3) for an infinitely small d > 0 [Edelsbrunner & Mucke 1990, Simulation of simplicity], which is the
// half-open rule of triangle rasterizers carried to tets. This holds where no tet is inverted and none overlap otherwise.
//
// Exact tests are the last resort. A cube's map is nearly affine: its inverse gives each centre's place in the cube with
// an error bounded by the cube's departure from affine, and only centres within that bound of a face are tested exactly.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/deform/lattice.h"

namespace limber {

// The voxel centres in the box of some posed points.
template <std::size_t N>
VoxelRange voxels_in_box(const std::array<FixedPoint, N>& points) {
  FixedPoint low = points[0], high = points[0];
  for (const auto& p : points) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  // Shifts of negative numbers round down.
  return {(low + (kFixedOne - 1)) >> 16, high >> 16};
}

// The side of a tet's four faces a voxel centre lies on, exactly. `Whole` holds the products: std::int64_t for tets
// within 16 voxels, __int128 for all.
template <class Whole>
class TetFaces {
 public:
  explicit TetFaces(const std::array<FixedPoint, 4>& posed) {
    using Vec = std::array<Whole, 3>;
    auto edge = [&](int to, int from) {
      return Vec{Whole(posed[to].x) - posed[from].x, Whole(posed[to].y) - posed[from].y, Whole(posed[to].z) - posed[from].z};
    };
    auto cross = [](const Vec& a, const Vec& b) {
      return Vec{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    const Vec a = edge(1, 0), b = edge(2, 0), c = edge(3, 0);
    normal_ = {Vec{}, cross(b, c), cross(c, a), cross(a, b)};
    determinant_ = normal_[1][0] * a[0] + normal_[1][1] * a[1] + normal_[1][2] * a[2];
    for (int i = 0; i < 3; ++i) normal_[0][i] = -(normal_[1][i] + normal_[2][i] + normal_[3][i]);
    const Whole sign = determinant_ < 0 ? -1 : 1;
    for (int f = 0; f < 4; ++f) {
      for (Whole& n : normal_[f]) n *= sign;
      from_[f] = posed[f == 0 ? 1 : 0];
      const Vec& n = normal_[f];
      const Whole first = n[0] != 0 ? n[0] : n[1] != 0 ? n[1] : n[2];
      on_face_[f] = first > 0 ? 1 : 0;
    }
  }

  int orientation() const { return determinant_ > 0 ? 1 : determinant_ < 0 ? -1 : 0; }

  // Positive exactly where the (infinitely little moved) centre lies on the tet's side of face f.
  Whole side(int f, const glm::ivec3& voxel) const {
    const auto& n = normal_[f];
    return n[0] * (Whole(voxel.x) * kFixedOne - from_[f].x) + n[1] * (Whole(voxel.y) * kFixedOne - from_[f].y) +
           n[2] * (Whole(voxel.z) * kFixedOne - from_[f].z) + on_face_[f];
  }
  Whole step_x(int f) const { return normal_[f][0] * kFixedOne; }

  bool contains(const glm::ivec3& voxel) const {
    return side(0, voxel) > 0 && side(1, voxel) > 0 && side(2, voxel) > 0 && side(3, voxel) > 0;
  }

 private:
  std::array<std::array<Whole, 3>, 4> normal_;  // face f lies opposite vertex f
  std::array<FixedPoint, 4> from_;              // a vertex of face f
  std::array<int, 4> on_face_;
  Whole determinant_;
};

// Of a row of voxels first .. last those with side > 0 everywhere: an interval, found by whole division.
template <class Whole>
void clip_row(Whole side_at_first, Whole step, Whole& first, Whole& last) {
  auto floor_div = [](Whole a, Whole b) { return a / b - (a % b < 0 ? 1 : 0); };  // b > 0
  if (step == 0) {
    if (side_at_first <= 0) last = first - 1;
  } else if (step > 0) {
    first = std::max(first, first + (side_at_first > 0 ? Whole(0) : floor_div(-side_at_first, step) + 1));
  } else {
    last = side_at_first <= 0 ? first - 1 : std::min(last, first + floor_div(side_at_first - 1, -step));
  }
}

template <class Whole, class Visit>
void visit_tet(const std::array<FixedPoint, 4>& posed, const VoxelRange& range, const Visit& visit) {
  const TetFaces<Whole> faces(posed);
  const int orientation = faces.orientation();
  if (orientation == 0) return;
  for (int z = range.low.z; z <= range.high.z; ++z)
    for (int y = range.low.y; y <= range.high.y; ++y) {
      Whole first = range.low.x, last = range.high.x;
      for (int f = 0; f < 4 && first <= last; ++f)
        clip_row<Whole>(faces.side(f, {int(first), y, z}), faces.step_x(f), first, last);
      for (int x = int(first); x <= int(last); ++x) visit(glm::ivec3(x, y, z), orientation);
    }
}

// visit(voxel, orientation) for every voxel of `clip` whose centre lies in the tet; orientation is 1, or -1 when the
// tet is inverted. A tet without volume has no voxels.
template <class Visit>
void rasterize_tet(const std::array<FixedPoint, 4>& posed, const VoxelRange& clip, const Visit& visit) {
  const VoxelRange range = intersect(voxels_in_box(posed), clip);
  if (range.empty()) return;
  FixedPoint low = posed[0], high = posed[0];
  for (const auto& p : posed) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  std::int64_t extent = 0;
  for (int axis = 0; axis < 3; ++axis) extent = std::max(extent, std::int64_t{high[axis]} - low[axis]);
  if (extent <= 16 * kFixedOne)
    visit_tet<std::int64_t>(posed, range, visit);
  else
    visit_tet<__int128>(posed, range, visit);
}

// What a cell says of a voxel centre.
struct CellClaim {
  glm::ivec3 voxel;       // of the output
  glm::dvec3 rest;        // rest point
  double posed_per_rest;  // volume ratio of the map there, in voxels; negative where it inverts
};

// The affine map of a tet, read backward at one posed voxel centre.
//   rest  vertices, positively oriented
CellClaim claim_in_tet(const std::array<FixedPoint, 4>& posed, const std::array<glm::dvec3, 4>& rest, const glm::ivec3& voxel);

// A tissue voxel's posed cube.
class PosedCell {
 public:
  // corner      bit 0 of the index is x, bit 1 y, bit 2 z
  // rest_voxel  its centre is the middle of the cube at rest
  PosedCell(const std::array<FixedPoint, 8>& corner, const glm::ivec3& rest_voxel);

  // claim(CellClaim) for every voxel of `range` whose centre lies in the cube.
  template <class Claim>
  void rasterize(const VoxelRange& range, const Claim& claim) const {
    if (!near_affine_) {
      for (int t = 0; t < kTets; ++t)
        rasterize_tet(posed_tet(t), range, [&](const glm::ivec3& v, int) { claim(claim_in(t, v)); });
      return;
    }
    for (int z = range.low.z; z <= range.high.z; ++z)
      for (int y = range.low.y; y <= range.high.y; ++y)
        for (int x = range.low.x; x <= range.high.x; ++x)
          if (const int t = find_tet({x, y, z}); t >= 0) claim(claim_in(t, {x, y, z}));
  }

 private:
  static constexpr int kTets = 5;

  int find_tet(const glm::ivec3& voxel) const;          // -1: outside
  int find_tet_exactly(const glm::ivec3& voxel) const;
  std::array<FixedPoint, 4> posed_tet(int t) const;
  CellClaim claim_in(int t, const glm::ivec3& voxel) const;

  std::array<FixedPoint, 8> corner_;
  glm::ivec3 rest_voxel_;
  int parity_;
  // The affine part: place in the cube, [-1, 1]^3, of a posed point, right to within slack_ on each axis.
  bool near_affine_ = false;
  glm::dmat3 place_from_posed_{1};
  glm::dvec3 middle_{0};
  double slack_ = 0;
};

}  // namespace limber
