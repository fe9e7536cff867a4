// SPDX-License-Identifier: AGPL-3.0-or-later
// Which voxel centres lie in a posed cell, and which rest point each of them is the image of.
//
// A cube is split into five tets: one on the four corners whose coordinates add up to an even number, four cut off at
// the odd corners. Neighbouring cubes are mirror images, so their diagonals meet. (The split into six tets around a
// main diagonal puts every voxel centre of the rest pose on an edge of all six; here it lies in the middle of one.)
//
// Every voxel centre covered by a mesh of such cells is claimed by exactly one tet, always: vertices are whole numbers
// of 1/65536 voxel, so the side of a face a centre lies on is computed exactly, and a centre *on* a face counts as
// moved by (d, d^2, d^3) for an infinitely small d > 0 [Edelsbrunner & Mucke 1990, Simulation of simplicity], which is
// the half-open rule of triangle rasterizers carried to tets. This holds where no tet is inverted and none overlap
// otherwise.
//
// Exact tests are the last resort. A cube's map is nearly affine: its inverse gives each centre's place in the cube
// with an error bounded by the cube's departure from affine, and only centres within that bound of a face are tested
// exactly. Where the departure is next to nothing that place is the rest point too, and the tets are not asked.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

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

constexpr int kSmallExtent = 16;  // voxels

// The side of a tet's four faces a voxel centre lies on, exactly. `Whole` holds the products: std::int64_t for tets
// within kSmallExtent, __int128 for all.
template <class Whole>
class TetFaces {
 public:
  explicit TetFaces(const std::array<FixedPoint, 4>& posed) {
    using Vec = std::array<Whole, 3>;
    auto edge = [&](int to, int from) {
      return Vec{Whole(posed[to].x) - posed[from].x, Whole(posed[to].y) - posed[from].y,
                 Whole(posed[to].z) - posed[from].z};
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
  const bool is_short = range.high.x - range.low.x < 4;  // asking each voxel takes less than dividing
  for (int z = range.low.z; z <= range.high.z; ++z)
    for (int y = range.low.y; y <= range.high.y; ++y) {
      if (is_short) {
        std::array<Whole, 4> side;
        for (int f = 0; f < 4; ++f) side[f] = faces.side(f, {range.low.x, y, z});
        for (int x = range.low.x; x <= range.high.x; ++x) {
          if (side[0] > 0 && side[1] > 0 && side[2] > 0 && side[3] > 0) visit(glm::ivec3(x, y, z), orientation);
          for (int f = 0; f < 4; ++f) side[f] += faces.step_x(f);
        }
        continue;
      }
      Whole first = range.low.x, last = range.high.x;
      for (int f = 0; f < 4 && first <= last; ++f)
        clip_row<Whole>(faces.side(f, {int(first), y, z}), faces.step_x(f), first, last);
      if (first > last) continue;  // where a face is nearly parallel to the row `first` may be far beyond an int
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
  if (extent <= kSmallExtent * kFixedOne) visit_tet<std::int64_t>(posed, range, visit);
  else visit_tet<__int128>(posed, range, visit);
}

// What a cell says of a voxel centre.
struct CellClaim {
  glm::ivec3 voxel;       // of the output
  glm::dvec3 rest;        // rest point
  double posed_per_rest;  // volume ratio of the map there, in voxels; negative where it inverts
};

// The affine map of a tet, read backward at one posed voxel centre.
//   rest  vertices, positively oriented
CellClaim claim_in_tet(const std::array<FixedPoint, 4>& posed, const std::array<glm::dvec3, 4>& rest,
                       const glm::ivec3& voxel);

// Four whole numbers in one register, the last unused.
using Lanes = int __attribute__((vector_size(16)));

// Two points that lie one behind the other in memory, in two loads.
inline std::array<Lanes, 2> lanes_of_two(const FixedPoint* points) {
  constexpr Lanes kThree{-1, -1, -1, 0};
  std::array<Lanes, 2> two;
  std::memcpy(&two[0], points, sizeof(Lanes));                                                     // x y z x
  std::memcpy(&two[1], reinterpret_cast<const char*>(points + 2) - sizeof(Lanes), sizeof(Lanes));  // z x y z
  two[1] = __builtin_shufflevector(two[1], two[1], 1, 2, 3, 0);
  return {two[0] & kThree, two[1] & kThree};
}

// A tissue voxel's posed cube.
class PosedCell {
 public:
  // lowest      its corner of least x, y and z at rest, in a lattice whose corners lie 1, `row` and `slice` apart; it
  // must
  //             outlive the cell
  // rest_voxel  its centre is the middle of the cube at rest
  PosedCell(const FixedPoint* lowest, int row, int slice, const glm::ivec3& rest_voxel)
      : lowest_(lowest),
        row_(row),
        slice_(slice),
        rest_voxel_(rest_voxel) {
    Lanes low = lanes_of_two(lowest)[0], high = low;
    for (int offset : {0, row, slice, slice + row})
      for (const Lanes c : lanes_of_two(lowest + offset)) {
        low = c < low ? c : low;
        high = c > high ? c : high;
      }
    low = (low + (kFixedOne - 1)) >> 16;  // shifts of negative numbers round down
    high >>= 16;
    box_ = {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
  }

  const VoxelRange& box() const { return box_; }  // the voxel centres in the box of its corners

  // claim(CellClaim) for every voxel of `clip` whose centre lies in the cube.
  template <class Claim>
  void rasterize(const VoxelRange& clip, const Claim& claim) const {
    const VoxelRange range = intersect(box_, clip);
    if (range.empty()) return;
    const Inverse inverse = affine_inverse();
    if (inverse.slack > kLargestSlack) {
      for (int t = 0; t < kTets; ++t)
        rasterize_tet(posed_tet(t), range, [&](const glm::ivec3& v, int) { claim(claim_in(t, v)); });
      return;
    }
    for (int z = range.low.z; z <= range.high.z; ++z)
      for (int y = range.low.y; y <= range.high.y; ++y) {
        const glm::dvec3 first = inverse.place_from_posed * (glm::dvec3(range.low.x, y, z) - inverse.middle);
        for (int x = range.low.x; x <= range.high.x; ++x) {
          const glm::ivec3 v(x, y, z);
          const glm::dvec3 place = first + double(x - range.low.x) * inverse.place_from_posed[0];
          const double outermost = std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)});
          if (outermost > 1 + inverse.slack) continue;
          const bool near_border = outermost > 1 - inverse.slack;
          if (inverse.slack > kAffineSlack) {
            const int t = near_border ? find_tet_exactly(v) : find_tet(v, place, inverse.slack);
            if (t >= 0) claim(claim_in(t, v));
          } else if (!near_border || find_tet_exactly(v) >= 0) {
            claim({v, glm::dvec3(rest_voxel_) + 0.5 * place, inverse.posed_per_rest});
          }
        }
      }
  }

 private:
  static constexpr int kTets = 5;
  // With a slack below a fifth no tet of the cube can be inverted (its edge matrix stays diagonally dominant).
  static constexpr double kLargestSlack = 0.1;
  static constexpr double kAffineSlack = 0.01;  // rest points are then right to within 0.005 voxel

  // The affine part of the cube's map, read backward.
  struct Inverse {
    glm::dmat3 place_from_posed{1};  // place in the cube, [-1, 1]^3
    glm::dvec3 middle{0};
    double posed_per_rest = 0;
    double slack = 1;  // places are right to within this on each axis
  };

  Inverse affine_inverse() const;
  int find_tet(const glm::ivec3& voxel, const glm::dvec3& place, double slack) const;  // of a voxel inside the cube
  int find_tet_exactly(const glm::ivec3& voxel) const;                                 // -1: outside
  template <class Whole>
  int first_tet_with(const glm::ivec3& voxel) const;
  std::array<FixedPoint, 4> posed_tet(int t) const;
  CellClaim claim_in(int t, const glm::ivec3& voxel) const;

  // Bit 0 of the index is x, bit 1 y, bit 2 z.
  const FixedPoint& corner(int i) const { return lowest_[(i & 1) + (i >> 1 & 1) * row_ + (i >> 2) * slice_]; }

  const FixedPoint* lowest_;
  int row_, slice_;
  VoxelRange box_;
  glm::ivec3 rest_voxel_;
};

}  // namespace limber
