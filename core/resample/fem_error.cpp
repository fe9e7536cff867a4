// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/fem_error.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "core/deform/carried_points.h"
#include "core/resample/fem_shape.h"

namespace limber {

namespace {

constexpr double kOrder = 1.25;  // the error is proportional to (edge length of the tets)^kOrder

glm::dvec3 middle_of(const Eigen::MatrixX3d& V, const Eigen::RowVector4i& tet) {
  const Eigen::RowVector3d sum = V.row(tet[0]) + V.row(tet[1]) + V.row(tet[2]) + V.row(tet[3]);
  return glm::dvec3(sum[0], sum[1], sum[2]) / 4.0;
}

}  // namespace

ShapeDifference difference_of(const FemShape& shape, const FemShape& other, const Grid& grid) {
  const TetMesh& mesh = shape.model.fem.mesh;
  const AffineTransform voxel = voxel_from_world(grid), world = world_from_voxel(grid);
  ShapeDifference difference;
  std::vector<PointToCarry> points;
  for (int t = 0; t < mesh.T.rows(); ++t) {
    if (mesh.region[t] != TetMesh::kSoft) continue;
    const glm::dvec3 at = voxel * middle_of(mesh.V, mesh.T.row(t));
    points.push_back({at, at});
    difference.tet.push_back(t);
  }
  const auto there = std::make_shared<const TetMesh>(other.model.fem.mesh);
  const auto posed = CarriedPoints(there, grid, points, other.solve.parameters.tet_mm).posed(other.V);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!posed[i]) continue;
    const int t = difference.tet[kept++] = difference.tet[i];
    difference.mm.push_back(glm::distance(world * *posed[i], middle_of(shape.V, mesh.T.row(t))));
  }
  difference.tet.resize(kept);
  return difference;
}

FemError estimated_error(const FemShape& fine, const FemShape& coarse, const Grid& grid) {
  FemError error;
  error.coarse_tet_mm = coarse.solve.parameters.tet_mm;
  const double ratio = error.coarse_tet_mm / fine.solve.parameters.tet_mm;
  if (!fine.solve.converged) error.unknown = "the solve did not reach the pose";
  else if (!coarse.solve.converged) error.unknown = "the second solve, with larger tets, did not reach the pose";
  else if (!(ratio > 1)) error.unknown = "the second solve has no larger tets";
  if (!error.unknown.empty()) return error;
  const ShapeDifference difference = difference_of(fine, coarse, grid);
  const TetMesh& mesh = fine.model.fem.mesh;
  std::vector<double> volume(difference.tet.size());
  for (std::size_t i = 0; i < volume.size(); ++i) volume[i] = signed_volume(mesh.V, mesh.T.row(difference.tet[i]));
  const double whole = std::accumulate(volume.begin(), volume.end(), 0.0);
  if (!(whole > 0)) {
    error.unknown = "the two meshes have no soft tissue in common";
    return error;
  }
  std::vector<std::size_t> order(volume.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(difference.mm[a], a) < std::pair(difference.mm[b], b);
  });
  const double beyond = 1 / (std::pow(ratio, kOrder) - 1);
  double below = 0, squares = 0;
  for (const std::size_t i : order) {
    squares += volume[i] * difference.mm[i] * difference.mm[i];
    if (below < 0.95 * whole) error.most_mm = beyond * difference.mm[i];
    below += volume[i];
  }
  error.rms_mm = beyond * std::sqrt(squares / whole);
  error.largest_mm = beyond * difference.mm[order.back()];
  error.place = middle_of(fine.V, mesh.T.row(difference.tet[order.back()]));
  return error;
}

}  // namespace limber
