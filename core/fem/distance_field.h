// SPDX-License-Identifier: AGPL-3.0-or-later
// The signed distance from a bone's surface, in mm, negative inside the bone, with its first and second derivatives. It
// is stored as samples on a regular grid at rest; between them it is a cubic B-spline with the samples as coefficients,
// which is smooth: its second derivatives are continuous. A bone is rigid, so one table serves for every pose, looked
// up in the bone's own frame. Beyond the grid the distance continues linearly.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/mesh/tet_mesh.h"

namespace limber {

struct DistanceAt {
  double mm;
  Eigen::Vector3d slope;      // first derivatives; of length 1 where the surface is flat
  Eigen::Matrix3d curvature;  // second derivatives of the distance, 1/mm
};

class DistanceField {
 public:
  // Samples a function in the box from `low` to `high`, world, mm.
  DistanceField(const Eigen::RowVector3d& low, const Eigen::RowVector3d& high, double spacing_mm,
                const std::function<double(const Eigen::RowVector3d&)>& distance);
  // Samples the distance from the surface of the tets whose region is `region`, and smooths it over a distance of
  // `smooth_mm`, so that the surface's edges become round. The sampled box contains the nodes `around`, with a margin
  // of `margin_mm`.
  DistanceField(const TetMesh& mesh, std::uint16_t region, std::span<const int> around, double margin_mm,
                double spacing_mm, double smooth_mm);

  DistanceAt at(const Eigen::RowVector3d& place) const;  // returns the distance at a position (world at rest, mm)

 private:
  void place_grid(const Eigen::RowVector3d& low, const Eigen::RowVector3d& high, double spacing_mm);
  Eigen::RowVector3d place_of(int x, int y, int z) const;
  std::size_t index(int x, int y, int z) const { return x + std::size_t(size_[0]) * (y + std::size_t(size_[1]) * z); }
  void smooth(int axis);

  Eigen::RowVector3d low_;
  double spacing_ = 1;
  std::array<int, 3> size_{};
  std::vector<float> mm_;  // distance at each sample of the grid, mm; x fastest
};

}  // namespace limber
