// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/carried_points.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"
#include "core/deform/box_bins.h"
#include "core/deform/mesh_border.h"

namespace limber {

namespace {

constexpr int kBin = 8;         // edge of a search bin, voxels
constexpr double kEdge = 1e-9;  // tolerance of barycentric coordinates, so that points on a face count as inside

glm::dvec3 in_mm(const Eigen::MatrixX3d& places, int row) { return {places(row, 0), places(row, 1), places(row, 2)}; }

std::array<double, 4> shares_in(const TetMesh& mesh, int tet, const glm::dvec3& world) {
  const auto c = mesh.T.row(tet);
  const glm::dvec3 a = in_mm(mesh.V, c[0]);
  const glm::dmat3 edges(in_mm(mesh.V, c[1]) - a, in_mm(mesh.V, c[2]) - a, in_mm(mesh.V, c[3]) - a);
  const glm::dvec3 s = glm::inverse(edges) * (world - a);
  return {1 - s.x - s.y - s.z, s.x, s.y, s.z};
}

BoxBins boxes_of(const TetMesh& mesh, const Grid& grid) {
  const AffineTransform voxel = voxel_from_world(grid);
  std::vector<VoxelRange> boxes(mesh.T.rows());
  for (int t = 0; t < mesh.T.rows(); ++t) {
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (const int node : mesh.T.row(t)) {
      const glm::dvec3 at = voxel * in_mm(mesh.V, node);
      low = glm::min(low, at);
      high = glm::max(high, at);
    }
    boxes[t] = {glm::ivec3(glm::floor(low)), glm::ivec3(glm::ceil(high))};
  }
  return {std::move(boxes), kBin};
}

}  // namespace

CarriedPoints::Hold CarriedPoints::hold_in(int tet, const glm::dvec3& world) const {
  Hold hold{.tet = tet, .shares = shares_in(*mesh_, tet, world)};
  for (int i = 0; i < 4; ++i) hold.nodes[i] = mesh_->T(tet, i);
  return hold;
}

CarriedPoints::CarriedPoints(std::shared_ptr<const TetMesh> mesh, const Grid& grid,
                             const std::vector<PointToCarry>& points, double furthest_mm)
    : mesh_(std::move(mesh)),
      voxel_from_world_(voxel_from_world(grid)),
      rest_(points.size()),
      holds_(points.size()) {
  if (mesh_->T.rows() == 0) return;
  const AffineTransform world_from_voxel = limber::world_from_voxel(grid);
  const BoxBins tets = boxes_of(*mesh_, grid);
  const MeshBorder border(*mesh_, grid);
  parallel_for(std::ssize(points), 64, [&](std::int64_t begin, std::int64_t end) {
    std::vector<int> near;
    for (auto i = begin; i < end; ++i) {
      const glm::dvec3 rest = points[i].rest, anchor = points[i].anchor, at = world_from_voxel * anchor;
      Hold& hold = holds_[i];
      rest_[i] = world_from_voxel * rest;
      tets.meeting({glm::ivec3(glm::floor(anchor)), glm::ivec3(glm::ceil(anchor))}, near);
      for (const int tet : near) {
        Hold candidate = hold_in(tet, at);
        if (std::any_of(candidate.shares.begin(), candidate.shares.end(),
                        [](double share) { return !(share >= -kEdge); }))
          continue;
        hold = candidate;
        break;
      }
      const bool is_inside = hold.tet >= 0;
      if (!is_inside) {
        const auto place = border.nearest(anchor, furthest_mm);
        if (!place) continue;
        hold.tet = place->tet;
        for (int c = 0; c < 3; ++c) hold.nodes[c] = place->corners[c], hold.shares[c] = place->shares[c];
        hold.nodes[3] = hold.nodes[0];
      }
      glm::dvec3 held(0);
      for (int c = 0; c < 4; ++c) held += hold.shares[c] * in_mm(mesh_->V, hold.nodes[c]);
      hold.off = is_inside && rest == anchor ? glm::dvec3(0) : rest_[i] - held;
    }
  });
}

std::vector<std::optional<glm::dvec3>> CarriedPoints::posed(const Eigen::MatrixX3d& posed) const {
  const Eigen::MatrixX3d moved = posed - mesh_->V;
  std::vector<std::optional<glm::dvec3>> places(holds_.size());
  parallel_for(std::ssize(holds_), 256, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = begin; i < end; ++i) {
      const Hold& hold = holds_[i];
      if (hold.tet < 0) continue;
      glm::dvec3 shift(0);
      for (int c = 0; c < 4; ++c) shift += hold.shares[c] * in_mm(moved, hold.nodes[c]);
      if (hold.off != glm::dvec3(0)) {
        const Eigen::Vector3d turned =
            rotation_of(*mesh_, moved, hold.tet) * Eigen::Vector3d(hold.off.x, hold.off.y, hold.off.z);
        shift += glm::dvec3(turned.x(), turned.y(), turned.z()) - hold.off;
      }
      places[i] = voxel_from_world_ * (rest_[i] + shift);
    }
  });
  return places;
}

}  // namespace limber
