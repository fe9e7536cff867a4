// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/mesh_border.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "core/deform/nearest_in_triangle.h"

namespace limber {

namespace {

constexpr int kBin = 8;  // edge of a search bin, voxels

glm::dvec3 in_mm(const Eigen::MatrixX3d& places, int row) { return {places(row, 0), places(row, 1), places(row, 2)}; }

}  // namespace

MeshBorder::MeshBorder(const TetMesh& mesh, const Grid& grid)
    : mesh_(&mesh),
      grid_(grid),
      world_from_voxel_(world_from_voxel(grid)) {
  const AffineTransform voxel = voxel_from_world(grid);
  const auto neighbours = neighbours_of(mesh);
  std::vector<VoxelRange> boxes;
  for (int t = 0; t < mesh.T.rows(); ++t)
    for (int f = 0; f < 4; ++f) {
      if (neighbours[t][f] >= 0) continue;
      faces_.push_back({{mesh.T(t, kTetFaces[f][0]), mesh.T(t, kTetFaces[f][1]), mesh.T(t, kTetFaces[f][2])}, t});
      glm::dvec3 low(INFINITY), high(-INFINITY);
      for (int node : faces_.back().corners) {
        const glm::dvec3 at = voxel * in_mm(mesh.V, node);
        low = glm::min(low, at);
        high = glm::max(high, at);
      }
      boxes.push_back({glm::ivec3(glm::floor(low)), glm::ivec3(glm::ceil(high))});
    }
  bins_ = BoxBins(std::move(boxes), kBin);
}

std::optional<MeshBorder::Place> MeshBorder::nearest(const glm::dvec3& rest, double furthest_mm, int side) const {
  const glm::dvec3 world = world_from_voxel_ * rest;
  const double least_spacing = std::min({grid_.spacing.x, grid_.spacing.y, grid_.spacing.z});
  std::vector<int> near;
  double least = furthest_mm * furthest_mm;
  int face = -1;
  glm::dvec3 shares(0);
  const int furthest = 2 * std::max({grid_.size.x, grid_.size.y, grid_.size.z}) + 64;
  double searched = 0;  // radius searched so far, mm
  for (int reach = 2; (face < 0 || least > searched * searched) && searched < furthest_mm && reach <= 2 * furthest;
       reach *= 2) {
    searched = reach * least_spacing;
    bins_.meeting({glm::ivec3(glm::floor(rest)) - reach, glm::ivec3(glm::ceil(rest)) + reach}, near);
    for (int f : near) {
      if (side >= 0 && mesh_->side[faces_[f].tet] != side) continue;
      const auto& c = faces_[f].corners;
      const glm::dvec3 s =
          nearest_in_triangle(world, in_mm(mesh_->V, c[0]), in_mm(mesh_->V, c[1]), in_mm(mesh_->V, c[2]));
      const glm::dvec3 off =
          s.x * in_mm(mesh_->V, c[0]) + s.y * in_mm(mesh_->V, c[1]) + s.z * in_mm(mesh_->V, c[2]) - world;
      if (const double squared = glm::dot(off, off); squared < least) {
        least = squared;
        face = f;
        shares = s;
      }
    }
  }
  if (face < 0) return std::nullopt;
  return Place{faces_[face].tet, faces_[face].corners, shares, std::sqrt(least)};
}

Eigen::Matrix3d rotation_of(const TetMesh& mesh, const Eigen::MatrixX3d& moved, int tet) {
  Eigen::Matrix3d rest, change;
  const auto corners = mesh.T.row(tet);
  for (int i = 0; i < 3; ++i) {
    rest.col(i) = (mesh.V.row(corners[i + 1]) - mesh.V.row(corners[0])).transpose();
    change.col(i) = (moved.row(corners[i + 1]) - moved.row(corners[0])).transpose();
  }
  if (change.isZero(0)) return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d gradient = Eigen::Matrix3d::Identity() + change * rest.inverse();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(gradient, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

}  // namespace limber
