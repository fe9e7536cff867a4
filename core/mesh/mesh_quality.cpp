// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/mesh_quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "core/base/parallel.h"
#include "core/mesh/voxel_ball.h"
#include "core/mesh/voxels_in_tet.h"

namespace limber {

namespace {

// An error of a region's volume is a fault if it is larger than this share of the total volume.
constexpr double kVolumeTolerance = 1e-9;

// Computes MeshQuality::covered and MeshQuality::near.
void measure_cover(const TetMesh& mesh, const Grid& grid, const TissueVoxels& tissue, MeshQuality& quality) {
  quality.covered = quality.near = 1;
  if (tissue.size() == 0) return;
  const AffineTransform to_voxel = voxel_from_world(grid);
  const bool mirrored = glm::determinant(to_voxel.linear) < 0;
  std::vector<glm::dvec3> V(mesh.V.rows());
  for (std::size_t i = 0; i < V.size(); ++i) V[i] = to_voxel * glm::dvec3(mesh.V(i, 0), mesh.V(i, 1), mesh.V(i, 2));
  // Lists the tets of each slice of voxels, so that each thread can process whole slices and no two threads write to
  // the same memory.
  std::vector<std::vector<int>> tets_of(grid.size.z);
  for (int tet = 0; tet < mesh.T.rows(); ++tet) {
    double low = 1e300, high = -1e300;
    for (const int c : mesh.T.row(tet)) low = std::min(low, V[c].z), high = std::max(high, V[c].z);
    for (int z = std::max(0, int(std::ceil(low - kHair)));
         z <= std::min(grid.size.z - 1, int(std::floor(high + kHair))); ++z)
      tets_of[z].push_back(tet);
  }
  std::vector<std::uint8_t> hit(grid.voxel_count(), 0);
  parallel_for(grid.size.z, 1, [&](std::int64_t begin, std::int64_t end) {
    for (int z = static_cast<int>(begin); z < end; ++z)
      for (const int tet : tets_of[z]) {
        glm::dvec3 corner[4];
        for (int i = 0; i < 4; ++i) corner[i] = V[mesh.T(tet, i)];
        if (mirrored) std::swap(corner[0], corner[1]);
        for_each_row_in_tet(corner, grid, z, z, [&](const glm::ivec3& first, const glm::ivec3& last) {
          std::fill_n(&hit[grid.index(first)], last.x - first.x + 1, 1);
        });
      }
  });
  const auto share_of = [&](const auto& passes) {
    return parallel_sum(std::ssize(tissue.bricks()), 256,
                        [&](std::int64_t begin, std::int64_t end) {
                          std::int64_t count = 0;
                          tissue.for_each(begin, end, [&](std::int64_t, const glm::ivec3& v) { count += passes(v); });
                          return double(count);
                        }) /
           double(tissue.size());
  };
  const auto is_hit = [&](const glm::ivec3& v) { return hit[grid.index(v)] != 0; };
  quality.covered = share_of(is_hit);
  quality.near = share_of([&](const glm::ivec3& v) {
    return is_hit(v) || any_voxel_near(v, grid, kNearVoxels, [&](const glm::ivec3& near) {
             return tissue.index_of(near) >= 0 && is_hit(near);
           });
  });
}

double total(const std::map<std::uint16_t, double>& volumes) {
  double sum = 0;
  for (const auto& [region, volume] : volumes) sum += volume;
  return sum;
}

// Returns true if a boundary is closed: its triangles pass each edge as often in one direction as in the other.
bool is_closed(const Eigen::MatrixX3i& F) {
  std::vector<std::pair<std::int64_t, int>> passes;
  passes.reserve(F.size());
  for (const auto& f : F.rowwise())
    for (int i = 0; i < 3; ++i) {
      const std::int64_t a = f[i], b = f[(i + 1) % 3];
      passes.push_back({std::min(a, b) << 32 | std::max(a, b), a < b ? 1 : -1});
    }
  std::sort(passes.begin(), passes.end());
  for (std::size_t i = 0; i < passes.size();) {
    int sum = 0;
    std::size_t end = i;
    for (; end < passes.size() && passes[end].first == passes[i].first; ++end) sum += passes[end].second;
    if (sum != 0) return false;
    i = end;
  }
  return true;
}

}  // namespace

MeshQuality quality_of(const TetMesh& mesh, const Grid& grid, const TissueVoxels& tissue) {
  MeshQuality quality;
  double smallest = std::numbers::pi;
  std::int64_t below = 0;
  for (const auto& tet : mesh.T.rowwise()) {
    const double angle = smallest_dihedral(mesh.V, tet);
    smallest = std::min(smallest, angle);
    below += angle < 5 * std::numbers::pi / 180;
  }
  quality.min_dihedral_degrees = mesh.T.rows() > 0 ? smallest * 180 / std::numbers::pi : 0;
  quality.share_below_5_degrees = mesh.T.rows() > 0 ? double(below) / double(mesh.T.rows()) : 0;
  measure_cover(mesh, grid, tissue, quality);
  quality.volume_ratio = total(region_volumes(mesh)) / (double(tissue.size()) * grid.voxel_volume());
  return quality;
}

std::map<std::uint16_t, double> region_volumes(const TetMesh& mesh) {
  std::map<std::uint16_t, double> volumes;
  for (Eigen::Index tet = 0; tet < mesh.T.rows(); ++tet)
    volumes[mesh.region[tet]] += signed_volume(mesh.V, mesh.T.row(tet));
  return volumes;
}

std::map<std::uint16_t, double> enclosed_volumes(const RegionSurface& surface, const Eigen::MatrixX3d& V) {
  std::map<std::uint16_t, double> volumes;
  if (surface.F.rows() == 0) return volumes;
  const Eigen::RowVector3d centre = V.topRows(surface.V.rows()).colwise().mean();
  for (Eigen::Index i = 0; i < surface.F.rows(); ++i) {
    const Eigen::RowVector3d a = V.row(surface.F(i, 0)) - centre, b = V.row(surface.F(i, 1)) - centre,
                             c = V.row(surface.F(i, 2)) - centre;
    const double volume = a.dot(b.cross(c)) / 6;
    volumes[surface.sides[i][1]] += volume;
    volumes[surface.sides[i][0]] -= volume;
  }
  volumes.erase(RegionSurface::kAir);
  return volumes;
}

std::string find_fault(const TetMesh& mesh, const std::map<std::uint16_t, double>& volumes) {
  if (!mesh.V.allFinite()) return "the position of a node is not finite";
  for (const auto& tet : mesh.T.rowwise())
    if (!(signed_volume(mesh.V, tet) > 0)) return "a tetrahedron is flat or inverted";
  const auto neighbours = neighbours_of(mesh.T);
  for (const auto& of_tet : neighbours)
    if (std::count(of_tet.begin(), of_tet.end(), -2) > 0) return "a face has more than two tetrahedra";
  if (!is_closed(boundary_of(mesh.T, neighbours))) return "the boundary is open";
  const auto has = region_volumes(mesh);
  const double tolerance = kVolumeTolerance * total(volumes);
  if (!(std::abs(total(has) - total(volumes)) <= tolerance)) return "the mesh's volume differs from the surface's";
  for (const auto& [region, volume] : volumes) {
    const auto found = has.find(region);
    if (!(std::abs((found == has.end() ? 0 : found->second) - volume) <= tolerance))
      return "a region's volume is not that of its surface";
  }
  return {};
}

}  // namespace limber
