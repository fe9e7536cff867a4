// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/crossings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/base/parallel.h"
#include "core/mesh/predicates.h"

namespace limber {

namespace {

using P2 = std::array<double, 2>;
using P3 = std::array<double, 3>;

struct Triangle {
  P3 corner[3];
  std::array<int, 3> node;
};

// --- Tests in a plane: points are projected along the axis in which the triangle's normal is longest, so that the
// projected triangle is not degenerate.

P2 flat(const P3& p, int axis) { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

bool between(const P2& a, const P2& b, const P2& p) {  // requires that the three points are on one line
  return std::min(a[0], b[0]) <= p[0] && p[0] <= std::max(a[0], b[0]) && std::min(a[1], b[1]) <= p[1] &&
         p[1] <= std::max(a[1], b[1]);
}

bool segments_meet(const P2& a, const P2& b, const P2& c, const P2& d) {
  const int abc = side_2d(a, b, c), abd = side_2d(a, b, d), cda = side_2d(c, d, a), cdb = side_2d(c, d, b);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && between(a, b, c)) || (abd == 0 && between(a, b, d)) || (cda == 0 && between(c, d, a)) ||
         (cdb == 0 && between(c, d, b));
}

bool inside(const P2 (&t)[3], const P2& p) {
  const int s[3] = {side_2d(t[0], t[1], p), side_2d(t[1], t[2], p), side_2d(t[2], t[0], p)};
  return (s[0] >= 0 && s[1] >= 0 && s[2] >= 0) || (s[0] <= 0 && s[1] <= 0 && s[2] <= 0);
}

int flattest_axis(const Triangle& t) {
  double normal[3];
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    normal[i] = std::abs((t.corner[1][j] - t.corner[0][j]) * (t.corner[2][k] - t.corner[0][k]) -
                         (t.corner[1][k] - t.corner[0][k]) * (t.corner[2][j] - t.corner[0][j]));
  }
  return static_cast<int>(std::max_element(normal, normal + 3) - normal);
}

bool meets_on_plane(const P3& p, const P3& q, const Triangle& t) {
  const int axis = flattest_axis(t);
  const P2 a = flat(p, axis), b = flat(q, axis),
           corner[3] = {flat(t.corner[0], axis), flat(t.corner[1], axis), flat(t.corner[2], axis)};
  if (inside(corner, a) || inside(corner, b)) return true;
  for (int i = 0; i < 3; ++i)
    if (segments_meet(a, b, corner[i], corner[(i + 1) % 3])) return true;
  return false;
}

// --- Tests of segments and triangles in space.

// Returns true if the segment from p to q and the triangle have a common point, including the triangle's border and the
// segment's ends.
bool segment_meets(const P3& p, const P3& q, const Triangle& t) {
  const int at_p = side_3d(t.corner[0], t.corner[1], t.corner[2], p),
            at_q = side_3d(t.corner[0], t.corner[1], t.corner[2], q);
  if (at_p * at_q > 0) return false;
  if (at_p == 0 && at_q == 0) return meets_on_plane(p, q, t);
  int low = 1, high = -1;
  for (int i = 0; i < 3; ++i) {
    const int side = side_3d(p, q, t.corner[i], t.corner[(i + 1) % 3]);
    low = std::min(low, side), high = std::max(high, side);
  }
  return low >= 0 || high <= 0;
}

bool upon_each_other(const Triangle& one, int apex_one, const Triangle& other, int apex_other) {
  const P3 &a = one.corner[(apex_one + 1) % 3], &b = one.corner[(apex_one + 2) % 3], &c = one.corner[apex_one],
           &d = other.corner[apex_other];
  if (side_3d(a, b, c, d) != 0) return false;
  const int axis = flattest_axis(one);
  return side_2d(flat(a, axis), flat(b, axis), flat(c, axis)) * side_2d(flat(a, axis), flat(b, axis), flat(d, axis)) >=
         0;
}

bool cross(const Triangle& one, const Triangle& other) {
  int shared = 0, apex_one = 0, apex_other = 0, common_one = 0, common_other = 0;
  for (int i = 0; i < 3; ++i) {
    const auto at = std::find(other.node.begin(), other.node.end(), one.node[i]);
    if (at != other.node.end()) ++shared, common_one = i, common_other = static_cast<int>(at - other.node.begin());
    else apex_one = i;
    if (std::find(one.node.begin(), one.node.end(), other.node[i]) == one.node.end()) apex_other = i;
  }
  if (shared == 3) return true;
  if (shared == 2) return upon_each_other(one, apex_one, other, apex_other);
  if (shared == 1)
    return segment_meets(one.corner[(common_one + 1) % 3], one.corner[(common_one + 2) % 3], other) ||
           segment_meets(other.corner[(common_other + 1) % 3], other.corner[(common_other + 2) % 3], one);
  for (int i = 0; i < 3; ++i)
    if (segment_meets(one.corner[i], one.corner[(i + 1) % 3], other) ||
        segment_meets(other.corner[i], other.corner[(i + 1) % 3], one))
      return true;
  return false;
}

// --- A uniform grid of cells, which finds triangles that are near each other.

struct Box {
  P3 low, high;
};

struct Entry {
  std::uint64_t cell;
  int triangle;
  bool operator<(const Entry& other) const {
    return cell != other.cell ? cell < other.cell : triangle < other.triangle;
  }
};

class Cells {
 public:
  explicit Cells(const std::vector<Box>& boxes) : boxes_(boxes) {
    low_ = boxes[0].low;
    double size = 0;
    for (const Box& box : boxes)
      for (int i = 0; i < 3; ++i)
        low_[i] = std::min(low_[i], box.low[i]), size += (box.high[i] - box.low[i]) / (3.0 * double(boxes.size()));
    side_ = std::max(2 * size, 1e-9);
    // Doubles the cell size while triangles would fill too many cells on average, because some are very large.
    constexpr double kMostEntries = 20;  // a larger mean number of cells per triangle is too many
    while (entries_needed() > kMostEntries * double(boxes.size())) side_ *= 2;
    for (std::size_t t = 0; t < boxes.size(); ++t) {
      const auto from = cell_of(boxes[t].low), to = cell_of(boxes[t].high);
      for (std::uint64_t z = from[2]; z <= to[2]; ++z)
        for (std::uint64_t y = from[1]; y <= to[1]; ++y)
          for (std::uint64_t x = from[0]; x <= to[0]; ++x) entries_.push_back({key({x, y, z}), static_cast<int>(t)});
    }
    std::sort(entries_.begin(), entries_.end());
    for (std::size_t i = 0; i < entries_.size(); ++i)
      if (i == 0 || entries_[i].cell != entries_[i - 1].cell) first_.push_back(i);
    first_.push_back(entries_.size());
  }

  std::int64_t count() const { return std::ssize(first_) - 1; }

  // Calls body for each pair of triangles in a cell whose bounding boxes overlap. A pair that is in several cells is
  // passed for only one of them.
  template <class Body>
  void for_each_pair(std::int64_t cell, const Body& body) const {
    for (std::size_t i = first_[cell]; i < first_[cell + 1]; ++i)
      for (std::size_t j = i + 1; j < first_[cell + 1]; ++j) {
        const Box &a = boxes_[entries_[i].triangle], &b = boxes_[entries_[j].triangle];
        P3 corner;
        bool meet = true;
        for (int k = 0; k < 3; ++k)
          corner[k] = std::max(a.low[k], b.low[k]), meet &= corner[k] <= std::min(a.high[k], b.high[k]);
        if (meet && key(cell_of(corner)) == entries_[i].cell) body(entries_[i].triangle, entries_[j].triangle);
      }
  }

 private:
  using Place = std::array<std::uint64_t, 3>;
  Place cell_of(const P3& p) const {
    Place place;
    for (int i = 0; i < 3; ++i) place[i] = static_cast<std::uint64_t>((p[i] - low_[i]) / side_);
    return place;
  }
  static std::uint64_t key(const Place& place) { return place[0] | place[1] << 21 | place[2] << 42; }
  double entries_needed() const {
    double sum = 0;
    for (const Box& box : boxes_) {
      const auto from = cell_of(box.low), to = cell_of(box.high);
      double cells = 1;
      for (int i = 0; i < 3; ++i) cells *= double(to[i] - from[i] + 1);
      sum += cells;
      if (*std::max_element(to.begin(), to.end()) >= 1 << 21) return 1e300;  // a cell's key has only 21 bits per axis
    }
    return sum;
  }

  const std::vector<Box>& boxes_;
  P3 low_;
  double side_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> first_;
};

}  // namespace

std::vector<std::array<int, 2>> crossing_pairs(const Eigen::MatrixX3d& V, const Eigen::MatrixX3i& F) {
  if (F.rows() == 0) return {};
  std::vector<Triangle> triangles(F.rows());
  std::vector<Box> boxes(F.rows());
  for (Eigen::Index t = 0; t < F.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      triangles[t].node[i] = F(t, i);
      for (int k = 0; k < 3; ++k) {
        const double place = triangles[t].corner[i][k] = V(F(t, i), k);
        boxes[t].low[k] = i == 0 ? place : std::min(boxes[t].low[k], place);
        boxes[t].high[k] = i == 0 ? place : std::max(boxes[t].high[k], place);
      }
    }
  const Cells cells(boxes);
  constexpr std::int64_t kGrain = 256;
  std::vector<std::vector<std::array<int, 2>>> found((cells.count() + kGrain - 1) / kGrain);
  parallel_for(cells.count(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t cell = begin; cell < end; ++cell)
      cells.for_each_pair(cell, [&](int a, int b) {
        if (cross(triangles[a], triangles[b])) found[begin / kGrain].push_back({a, b});
      });
  });
  std::vector<std::array<int, 2>> pairs;
  for (const auto& part : found) pairs.insert(pairs.end(), part.begin(), part.end());
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace limber
