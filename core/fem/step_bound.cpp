// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/step_bound.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "core/base/parallel.h"

namespace limber {

namespace {
constexpr std::int64_t kGrain = 4096;
constexpr double kKept = 0.1;  // smallest share of a tet's volume that must be left after a step
// A required volume `keep` above this share of the tet's current volume is lowered to this share.
constexpr double kHalf = 0.5;

// Returns the first a in (0, limit] at which c0 + c1 a + c2 a^2 + c3 a^3 falls to zero, rounded down; `limit` if there
// is none. c0 must be positive.
double first_root(double c0, double c1, double c2, double c3, double limit) {
  const auto f = [&](double a) { return c0 + a * (c1 + a * (c2 + a * c3)); };
  const auto falling = [](double c) { return std::min(c, 0.0); };
  if (c0 + limit * (falling(c1) + limit * (falling(c2) + limit * falling(c3))) > 0) return limit;

  // Searches between the cubic's extremes, where it is monotonic.
  double extreme[2] = {limit, limit};
  const double discriminant = c2 * c2 - 3 * c3 * c1;
  if (discriminant > 0) {
    const double q = -(c2 + std::copysign(std::sqrt(discriminant), c2));
    for (const double a : {q / (3 * c3), c1 / q})
      if (a > 0 && a < limit) (extreme[0] == limit ? extreme[0] : extreme[1]) = a;
    if (extreme[0] > extreme[1]) std::swap(extreme[0], extreme[1]);
  }
  double low = 0;
  for (const double high_end : {extreme[0], extreme[1], limit}) {
    if (f(high_end) > 0) {
      low = high_end;
      continue;
    }
    double high = high_end;
    for (int i = 0; i < 60 && high - low > 1e-12 * high; ++i) {
      const double middle = 0.5 * (low + high);
      (f(middle) > 0 ? low : high) = middle;
    }
    return low;
  }
  return limit;
}

double tet_bound(const Eigen::Vector4i& t, const NodePositions& x, const NodePositions& step, double keep,
                 double limit) {
  const Eigen::Vector3d o = x.row(t[0]), p = step.row(t[0]);
  const Eigen::Vector3d a = x.row(t[1]).transpose() - o, b = x.row(t[2]).transpose() - o,
                        c = x.row(t[3]).transpose() - o;
  const Eigen::Vector3d u = step.row(t[1]).transpose() - p, v = step.row(t[2]).transpose() - p,
                        w = step.row(t[3]).transpose() - p;
  const Eigen::Vector3d bc = b.cross(c), vw = v.cross(w), mixed = v.cross(c) + b.cross(w);
  const double volume = a.dot(bc);
  const double kept = std::max(kKept * volume, std::min(kHalf * volume, keep));
  return first_root(volume - kept, u.dot(bc) + a.dot(mixed), a.dot(vw) + u.dot(mixed), u.dot(vw), limit);
}
}  // namespace

StepBound largest_step(const Eigen::MatrixX4i& T, const NodePositions& x, const NodePositions& step, double limit,
                       std::span<const double> keep) {
  std::vector<StepBound> of_block((T.rows() + kGrain - 1) / kGrain, {limit, -1});
  parallel_for(T.rows(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    StepBound& bound = of_block[begin / kGrain];
    for (auto t = begin; t < end; ++t) {
      const double length = tet_bound(T.row(t), x, step, keep.empty() ? 0 : keep[t], bound.length);
      if (length < bound.length) bound = {length, t};
    }
  });
  StepBound bound{limit, -1};
  for (const auto& block : of_block)
    if (block.length < bound.length) bound = block;
  return bound;
}

double determinant(const NodePositions& x, int a, int b, int c, int d) {
  const Eigen::RowVector3d o = x.row(a);
  return (x.row(b) - o).dot((x.row(c) - o).cross(x.row(d) - o));
}

std::int64_t count_inverted(const Eigen::MatrixX4i& T, const NodePositions& x) {
  std::int64_t count = 0;
  for (Eigen::Index t = 0; t < T.rows(); ++t) count += !(determinant(x, T(t, 0), T(t, 1), T(t, 2), T(t, 3)) > 0);
  return count;
}

}  // namespace limber
