// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/distance_field.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>

#include "core/deform/nearest_in_triangle.h"
#include "core/volume/distance_transform.h"

namespace limber {

namespace {

// Distance from the surface, in sample spacings, within which samples are the exact distance from the nearest triangle.
constexpr double kExact = 6;
constexpr int kBorder = 2;  // number of samples beyond the box on each side, since a cubic spline needs two

// The four weights of the uniform cubic B-spline at t in [0, 1], with their first and second derivatives by t.
struct Cubic {
  std::array<double, 4> value, slope, curvature;
  explicit Cubic(double t) {
    const double s = 1 - t;
    value = {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6, t * t * t / 6};
    slope = {-s * s / 2, (3 * t * t - 4 * t) / 2, -(3 * s * s - 4 * s) / 2, t * t / 2};
    curvature = {s, 3 * t - 2, 3 * s - 2, t};
  }
};

glm::dvec3 vec_of(const Eigen::RowVector3d& p) { return {p[0], p[1], p[2]}; }

// Calls body(x, y, z) for the samples in the box, clamped to the grid.
template <class Body>
void for_box(const std::array<int, 3>& size, const Eigen::RowVector3d& low, const Eigen::RowVector3d& high,
             const Body& body) {
  std::array<int, 3> first, last;
  for (int c = 0; c < 3; ++c) {
    first[c] = std::max(0, int(std::ceil(low[c])));
    last[c] = std::min(size[c] - 1, int(std::floor(high[c])));
  }
  for (int z = first[2]; z <= last[2]; ++z)
    for (int y = first[1]; y <= last[1]; ++y)
      for (int x = first[0]; x <= last[0]; ++x) body(x, y, z);
}

}  // namespace

void DistanceField::place_grid(const Eigen::RowVector3d& low, const Eigen::RowVector3d& high, double spacing_mm) {
  spacing_ = spacing_mm;
  low_ = low.array() - kBorder * spacing_mm;
  for (int c = 0; c < 3; ++c) size_[c] = int(std::ceil((high[c] - low[c]) / spacing_mm)) + 2 * kBorder + 1;
  mm_.resize(std::size_t(size_[0]) * size_[1] * size_[2]);
}

Eigen::RowVector3d DistanceField::place_of(int x, int y, int z) const {
  return low_ + spacing_ * Eigen::RowVector3d(x, y, z);
}

DistanceField::DistanceField(const Eigen::RowVector3d& low, const Eigen::RowVector3d& high, double spacing_mm,
                             const std::function<double(const Eigen::RowVector3d&)>& distance) {
  place_grid(low, high, spacing_mm);
  for (int z = 0; z < size_[2]; ++z)
    for (int y = 0; y < size_[1]; ++y)
      for (int x = 0; x < size_[0]; ++x) mm_[index(x, y, z)] = float(distance(place_of(x, y, z)));
}

DistanceField::DistanceField(const TetMesh& mesh, std::uint16_t region, std::span<const int> around, double margin_mm,
                             double spacing_mm, double smooth_mm) {
  Eigen::RowVector3d low = Eigen::RowVector3d::Constant(INFINITY), high = -low;
  for (const int v : around) {
    low = low.cwiseMin(mesh.V.row(v));
    high = high.cwiseMax(mesh.V.row(v));
  }
  place_grid(low.array() - margin_mm, high.array() + margin_mm, spacing_mm);
  std::vector<Eigen::Index> own;
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    if (mesh.region[t] == region) own.push_back(t);
  const Eigen::MatrixX4i T = mesh.T(own, Eigen::all);
  const auto in_grid = [&](int v) -> Eigen::RowVector3d { return (mesh.V.row(v) - low_) / spacing_; };

  std::vector<std::uint8_t> inside(mm_.size(), 0);
  for (Eigen::Index t = 0; t < T.rows(); ++t) {
    const Eigen::RowVector3d a = in_grid(T(t, 0));
    Eigen::Matrix3d edges;
    Eigen::RowVector3d first = a, last = a;
    for (int i = 0; i < 3; ++i) {
      const Eigen::RowVector3d p = in_grid(T(t, i + 1));
      edges.col(i) = (p - a).transpose();
      first = first.cwiseMin(p), last = last.cwiseMax(p);
    }
    const Eigen::Matrix3d shares = edges.inverse();
    for_box(size_, first, last, [&](int x, int y, int z) {
      const Eigen::Vector3d share = shares * (Eigen::RowVector3d(x, y, z) - a).transpose();
      if (share.minCoeff() >= 0 && share.sum() <= 1) inside[index(x, y, z)] = 1;
    });
  }
  const std::vector<float> far = signed_distance({{}, {size_[0], size_[1], size_[2]}}, inside, glm::dvec3(spacing_));
  // The distance transform measures between centres of samples, so it is half a spacing too far.
  std::transform(far.begin(), far.end(), mm_.begin(), [&](float mm) {
    const double most = 1e3 * spacing_;
    return float(std::clamp(mm - std::copysign(0.5 * spacing_, double(mm)), -most, most));
  });

  std::vector<float> near(mm_.size(), INFINITY);
  const Eigen::MatrixX3i surface = boundary_of(T);
  for (const auto& f : surface.rowwise()) {
    const Eigen::RowVector3d a = in_grid(f[0]), b = in_grid(f[1]), c = in_grid(f[2]);
    for_box(size_, a.cwiseMin(b).cwiseMin(c).array() - kExact, a.cwiseMax(b).cwiseMax(c).array() + kExact,
            [&](int x, int y, int z) {
              const glm::dvec3 p(x, y, z), s = nearest_in_triangle(p, vec_of(a), vec_of(b), vec_of(c));
              float& least = near[index(x, y, z)];
              least = std::min(least, float(glm::distance(p, s.x * vec_of(a) + s.y * vec_of(b) + s.z * vec_of(c))));
            });
  }
  for (std::size_t i = 0; i < mm_.size(); ++i)
    if (near[i] <= kExact) mm_[i] = float(spacing_) * (inside[i] ? -near[i] : near[i]);
  // Each pass with the weights 1/4, 1/2, 1/4 adds half a squared spacing to the variance of the smoothing, which is to
  // be the square of smooth_mm.
  const int passes = int(std::lround(2 * std::pow(smooth_mm / spacing_, 2)));
  for (int pass = 0; pass < passes; ++pass)
    for (int axis = 0; axis < 3; ++axis) smooth(axis);
}

void DistanceField::smooth(int axis) {
  const std::size_t stride = axis == 0 ? 1 : axis == 1 ? size_[0] : std::size_t(size_[0]) * size_[1];
  const std::vector<float> before = mm_;
  for (int z = 0; z < size_[2]; ++z)
    for (int y = 0; y < size_[1]; ++y)
      for (int x = 0; x < size_[0]; ++x) {
        const int along = axis == 0 ? x : axis == 1 ? y : z;
        if (along == 0 || along == size_[axis] - 1) continue;
        const std::size_t i = index(x, y, z);
        mm_[i] = 0.25F * before[i - stride] + 0.5F * before[i] + 0.25F * before[i + stride];
      }
}

DistanceAt DistanceField::at(const Eigen::RowVector3d& place) const {
  std::array<int, 3> first;
  std::array<Cubic, 3> cubic{Cubic(0), Cubic(0), Cubic(0)};
  Eigen::RowVector3d inside;  // the position in the grid that is nearest to `place`
  bool is_inside = true;
  for (int c = 0; c < 3; ++c) {
    const double at = (place[c] - low_[c]) / spacing_, held = std::clamp(at, 1.0, size_[c] - 2.0);
    first[c] = std::min(int(held), size_[c] - 3) - 1;
    cubic[c] = Cubic(held - 1 - first[c]);
    inside[c] = low_[c] + held * spacing_;
    is_inside = is_inside && held == at;
  }
  DistanceAt result{0, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) {
        const double mm = mm_[index(first[0] + i, first[1] + j, first[2] + k)];
        const double x = cubic[0].value[i], y = cubic[1].value[j], z = cubic[2].value[k];
        const double dx = cubic[0].slope[i], dy = cubic[1].slope[j], dz = cubic[2].slope[k];
        result.mm += mm * x * y * z;
        result.slope += mm * Eigen::Vector3d(dx * y * z, x * dy * z, x * y * dz);
        result.curvature(0, 0) += mm * cubic[0].curvature[i] * y * z;
        result.curvature(1, 1) += mm * x * cubic[1].curvature[j] * z;
        result.curvature(2, 2) += mm * x * y * cubic[2].curvature[k];
        result.curvature(0, 1) += mm * dx * dy * z;
        result.curvature(0, 2) += mm * dx * y * dz;
        result.curvature(1, 2) += mm * x * dy * dz;
      }
  result.slope /= spacing_;
  result.curvature /= spacing_ * spacing_;
  for (int c = 0; c < 3; ++c)
    for (int d = 0; d < c; ++d) result.curvature(c, d) = result.curvature(d, c);
  if (!is_inside) {
    result.mm += (place - inside).dot(result.slope.transpose());
    result.curvature.setZero();
  }
  return result;
}

}  // namespace limber
