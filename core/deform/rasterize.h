// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds which voxel centres lie in a posed cell, and which rest point the pose moves to each of them.
//
// A cube is split into five tets: one on the four corners with an even sum of coordinates, and four cut off at the
// other corners. Neighbouring cubes are mirror images, so the diagonals on their common face coincide. (A split into
// six tets around a main diagonal would put every voxel centre of the rest pose on an edge of all six; here the centre
// is in the middle of one tet.)
//
// Exactly one tet claims every voxel centre that a mesh of such cells covers. Vertices are integers in units of 1/65536
// voxel, so the side of a face on which a centre lies is computed exactly. A centre *on* a face is treated as if it
// were moved by (d, d^2, d^3) for an infinitely small d > 0 [Edelsbrunner & Mucke 1990, Simulation of simplicity]. This
// is the half-open rule of triangle rasterizers, extended to tets. It holds if no tet is inverted and no tets overlap.
//
// Exact tests are only made where they are needed. The map from a cube at rest to the posed cube is nearly affine. The
// inverse of its affine part gives each centre's position in the cube, with an error that is at most the *slack*. Only
// centres that are nearer to a face than the slack are tested exactly. If the slack is tiny, the position in the cube
// also gives the rest point, and no tet is needed.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/deform/lattice.h"

namespace limber {

// Returns the range of voxels whose centres lie in the bounding box of posed points.
template <std::size_t N>
VoxelRange voxels_in_box(const std::array<FixedPoint, N>& points) {
  FixedPoint low = points[0], high = points[0];
  for (const auto& p : points) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  // Right shifts of negative numbers round down.
  return {(low + (kFixedOne - 1)) >> 16, high >> 16};
}

constexpr int kSmallExtent = 16;  // up to this extent in voxels, the products of a tet's face tests fit std::int64_t

// Computes exactly on which side of each of a tet's four faces a voxel centre lies. `Whole` is the integer type of the
// products: std::int64_t for tets within kSmallExtent, __int128 for larger ones.
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

  // Returns a positive number if the voxel centre is on the inner side of face f of the tet, otherwise zero or less. A
  // centre exactly on the face is treated as if it were moved by (d, d^2, d^3) for an infinitely small d > 0.
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
  std::array<std::array<Whole, 3>, 4> normal_;  // normal of face f, which lies opposite vertex f
  std::array<FixedPoint, 4> from_;              // one vertex of face f
  std::array<int, 4> on_face_;
  Whole determinant_;
};

// Clips a row of voxels `first` to `last` to those whose side() is above 0. These voxels form an interval, since side()
// changes by the constant `step` from voxel to voxel. Integer division gives the interval's ends.
template <class Whole>
void clip_row(Whole side_at_first, Whole step, Whole& first, Whole& last) {
  // Returns floor(a / b); requires b > 0.
  auto floor_div = [](Whole a, Whole b) { return a / b - (a % b < 0 ? 1 : 0); };
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
  const bool is_short = range.high.x - range.low.x < 4;  // for short rows, testing each voxel is faster than dividing
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
      if (first > last) continue;  // if a face is nearly parallel to the row, `first` may then be too large for an int
      for (int x = int(first); x <= int(last); ++x) visit(glm::ivec3(x, y, z), orientation);
    }
}

// Calls visit(voxel, orientation) for every voxel of `clip` whose centre lies in the tet. The orientation is 1, or -1
// if the tet is inverted. A tet without volume contains no voxels.
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

// The claim of a cell on a voxel whose centre its posed image covers.
struct CellClaim {
  glm::ivec3 voxel;       // the output voxel that is claimed
  glm::dvec3 rest;        // rest point that the pose moves to the voxel's centre
  double posed_per_rest;  // local ratio of posed to rest volume, in voxels; negative in inverted cells
};

// Returns the claim on a posed voxel centre, by the inverse of a tet's affine map.
//   rest  vertices at rest, positively oriented
CellClaim claim_in_tet(const std::array<FixedPoint, 4>& posed, const std::array<glm::dvec3, 4>& rest,
                       const glm::ivec3& voxel);

// SIMD register of four integers; the last one is unused.
using Lanes = int __attribute__((vector_size(16)));

// Loads two adjacent points by two unaligned loads of 16 bytes.
inline std::array<Lanes, 2> lanes_of_two(const FixedPoint* points) {
  constexpr Lanes kThree{-1, -1, -1, 0};
  std::array<Lanes, 2> two;
  // Loads x, y, z of the first point and x of the second.
  std::memcpy(&two[0], points, sizeof(Lanes));
  // Loads z of the first point and x, y, z of the second.
  std::memcpy(&two[1], reinterpret_cast<const char*>(points + 2) - sizeof(Lanes), sizeof(Lanes));
  two[1] = __builtin_shufflevector(two[1], two[1], 1, 2, 3, 0);
  return {two[0] & kThree, two[1] & kThree};
}

// The posed cube of a tissue voxel.
class PosedCell {
 public:
  //   lowest      the corner with the smallest x, y and z at rest. In its array, the next corner along x, y and z is 1,
  //               `row` and `slice` elements further. The array must outlive the cell
  //   rest_voxel  the voxel whose centre is the centre of the cube at rest
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
    low = (low + (kFixedOne - 1)) >> 16;  // right shifts of negative numbers round down
    high >>= 16;
    box_ = {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
  }

  const VoxelRange& box() const { return box_; }  // voxels with centres in the cube's bounding box

  // Calls claim(CellClaim) for every voxel of `clip` whose centre lies in the cube.
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
  // Upper limit on Inverse::slack; cubes with a larger slack are rasterized tet by tet. With a slack below 0.2 no tet
  // of the cube can be inverted (its edge matrix stays diagonally dominant).
  static constexpr double kLargestSlack = 0.1;
  // A cube's map counts as affine if its Inverse::slack is at most this; its rest points are then correct to within
  // 0.005 voxel.
  static constexpr double kAffineSlack = 0.01;

  // The inverse of the affine part of the map from a cube's rest position to its posed position.
  struct Inverse {
    glm::dmat3 place_from_posed{1};  // (posed point - middle) -> position in the cube, [-1, 1]^3
    glm::dvec3 middle{0};            // posed centre of the cube
    double posed_per_rest = 0;
    double slack = 1;  // upper limit on the error of a position in the cube along each axis
  };

  Inverse affine_inverse() const;
  // Returns the index of the tet that contains the centre of a voxel. The centre must lie in the cube.
  int find_tet(const glm::ivec3& voxel, const glm::dvec3& place, double slack) const;
  int find_tet_exactly(const glm::ivec3& voxel) const;  // -1: the voxel's centre is outside the cube
  template <class Whole>
  int first_tet_with(const glm::ivec3& voxel) const;
  std::array<FixedPoint, 4> posed_tet(int t) const;
  CellClaim claim_in(int t, const glm::ivec3& voxel) const;

  // Returns a posed corner; bits 0, 1, 2 of its index are x, y, z.
  const FixedPoint& corner(int i) const { return lowest_[(i & 1) + (i >> 1 & 1) * row_ + (i >> 2) * slice_]; }

  const FixedPoint* lowest_;
  int row_, slice_;
  VoxelRange box_;
  glm::ivec3 rest_voxel_;
};

}  // namespace limber
