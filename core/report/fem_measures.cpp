// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/fem_measures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/LU>

#include "core/base/parallel.h"
#include "core/fem/contact_gap.h"
#include "core/fem/tet_energy.h"
#include "core/mesh/voxels_in_tet.h"

namespace limber {

namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity(), kNone = std::numeric_limits<float>::quiet_NaN();
constexpr int kSticksOut = 2;  // a voxel at most this many voxels outside the mesh gets a neighbour's tet

Eigen::Matrix3d edges(const Eigen::MatrixX3d& V, const Eigen::MatrixX4i& T, std::int64_t t) {
  Eigen::Matrix3d columns;
  for (int i = 0; i < 3; ++i) columns.col(i) = (V.row(T(t, i + 1)) - V.row(T(t, 0))).transpose();
  return columns;
}

double energy_of(const TetMaterial& material, const Eigen::Matrix3d& F) {
  const double J = F.determinant();
  return J > 0 ? energy_density({.shear = material.shear_modulus, .bulk = tet_bulk(material)}, F, J) : kInfinite;
}

// Returns the root mean square of the tets' edge lengths in mm. Only gaps below this distance are measured, and only to
// skin that was more than three times this distance away at rest, since such skin must have folded.
double mean_edge(const TetMesh& mesh) {
  double sum = 0;
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    for (int a = 0; a < 4; ++a)
      for (int b = a + 1; b < 4; ++b) sum += (mesh.V.row(mesh.T(t, a)) - mesh.V.row(mesh.T(t, b))).squaredNorm();
  return std::sqrt(sum / std::max(1.0, 6.0 * double(mesh.T.rows())));
}

std::vector<float> gaps(const TetMesh& mesh, const Eigen::MatrixX3d& V) {
  const double edge = mean_edge(mesh);
  const std::vector<double> of_node = contact_gaps(mesh.V, V, boundary_of(mesh), 3 * edge, edge);
  std::vector<float> of_tet(mesh.T.rows(), kInfinite);
  for (std::size_t t = 0; t < of_tet.size(); ++t)
    for (int i = 0; i < 4; ++i) of_tet[t] = std::min(of_tet[t], static_cast<float>(of_node[mesh.T(t, i)]));
  return of_tet;
}

}  // namespace

std::vector<float> fem_measure(FemMeasure measure, const FemMesh& mesh, const Eigen::MatrixX3d& V) {
  const TetMesh& tets = mesh.tets;
  std::vector<float> values = measure == FemMeasure::Gap ? gaps(tets, V) : std::vector<float>(tets.T.rows());
  parallel_for(std::ssize(values), 2048, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t t = begin; t < end; ++t) {
      if (mesh.joint[t]) {
        values[t] = kNone;
      } else if (measure != FemMeasure::Gap) {
        const Eigen::Matrix3d F = edges(V, tets.T, t) * edges(tets.V, tets.T, t).inverse();
        values[t] =
            static_cast<float>(measure == FemMeasure::VolumeRatio ? F.determinant() : energy_of(mesh.material[t], F));
      }
    }
  });
  return values;
}

float measure_at_rest(FemMeasure measure) {
  return measure == FemMeasure::VolumeRatio ? 1.0f : measure == FemMeasure::EnergyDensity ? 0.0f : kInfinite;
}

std::vector<std::int32_t> tets_of_voxels(const Eigen::MatrixX4i& T, const Eigen::MatrixX3d& V, const Grid& grid,
                                         const TissueVoxels& tissue) {
  const AffineTransform to_voxel = voxel_from_world(grid);
  std::vector<glm::dvec3> nodes(V.rows());
  for (std::size_t v = 0; v < nodes.size(); ++v) nodes[v] = to_voxel * glm::dvec3(V(v, 0), V(v, 1), V(v, 2));
  const bool mirrored = glm::determinant(to_voxel.linear) < 0;  // true: tets are inverted in voxel coordinates

  // A thread handles whole layers of bricks (cubes of 8^3 voxels). Layers share no voxel, so no two threads write the
  // same voxel.
  const int layers = tissue.brick_grid().z;
  std::vector<std::vector<std::int32_t>> of_layer(layers);
  for (Eigen::Index t = 0; t < T.rows(); ++t) {
    const auto [low, high] = std::minmax({nodes[T(t, 0)].z, nodes[T(t, 1)].z, nodes[T(t, 2)].z, nodes[T(t, 3)].z});
    const int first = std::max(0, static_cast<int>(std::floor(low)) / TissueVoxels::kBrick),
              last = std::min(layers - 1, static_cast<int>(std::ceil(high)) / TissueVoxels::kBrick);
    if (high >= -1)
      for (int layer = first; layer <= last; ++layer) of_layer[layer].push_back(static_cast<std::int32_t>(t));
  }
  std::vector<std::int32_t> tets(tissue.size(), -1);
  parallel_for(layers, 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t layer = begin; layer < end; ++layer)
      for (const std::int32_t t : of_layer[layer]) {
        glm::dvec3 corner[4];
        for (int i = 0; i < 4; ++i) corner[i] = nodes[T(t, i)];
        if (mirrored) std::swap(corner[0], corner[1]);
        const int first = static_cast<int>(layer) * TissueVoxels::kBrick;
        for_each_row_in_tet(corner, grid, first, std::min(first + TissueVoxels::kBrick, grid.size.z) - 1,
                            [&](const glm::ivec3& from, const glm::ivec3& to) {
                              for (glm::ivec3 v = from; v.x <= to.x; ++v.x)
                                if (const std::int64_t place = tissue.index_of(v); place >= 0 && tets[place] < 0)
                                  tets[place] = t;
                            });
      }
  });

  for (int round = 0; round < kSticksOut; ++round) {
    std::vector<std::int32_t> wider = tets;
    tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
      for (int side = 0; side < 6 && wider[place] < 0; ++side) {
        glm::ivec3 near = v;
        near[side / 2] += side % 2 ? 1 : -1;
        if (!grid.contains(near)) continue;
        if (const std::int64_t beside = tissue.index_of(near); beside >= 0) wider[place] = tets[beside];
      }
    });
    tets = std::move(wider);
  }
  return tets;
}

}  // namespace limber
