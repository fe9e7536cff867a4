// SPDX-License-Identifier: AGPL-3.0-or-later
// A box of tets for tests: a lattice of cubes, each split into six tets around its main diagonal [Kuhn 1960].
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include <Eigen/Geometry>
#include <glm/glm.hpp>

#include "core/mesh/tet_mesh.h"
#include "core/volume/label_volume.h"

namespace limber::test {

// Returns the mesh of a box.
//   low, high  corners of the box, in voxel coordinates of `grid`
//   cubes      number of cubes along each axis
inline TetMesh kuhn_mesh(const Grid& grid, const glm::dvec3& low, const glm::dvec3& high, const glm::ivec3& cubes) {
  const AffineTransform world = world_from_voxel(grid);
  const glm::ivec3 side = cubes + 1;
  const auto at = [&](const glm::ivec3& c) { return c.x + side.x * (c.y + side.y * c.z); };
  TetMesh mesh;
  mesh.V.resize(side.x * side.y * side.z, 3);
  for (int z = 0; z < side.z; ++z)
    for (int y = 0; y < side.y; ++y)
      for (int x = 0; x < side.x; ++x) {
        const glm::dvec3 p = world * (low + (high - low) * glm::dvec3(x, y, z) / glm::dvec3(cubes));
        mesh.V.row(at({x, y, z})) << p.x, p.y, p.z;
      }
  constexpr std::array<std::array<int, 3>, 6> kOrders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}}};
  mesh.T.resize(6 * cubes.x * cubes.y * cubes.z, 4);
  int row = 0;
  for (int z = 0; z < cubes.z; ++z)
    for (int y = 0; y < cubes.y; ++y)
      for (int x = 0; x < cubes.x; ++x)
        for (const auto& order : kOrders) {
          glm::ivec3 c(x, y, z);
          std::array<int, 4> corner{at(c)};
          for (int i = 0; i < 3; ++i) {
            ++c[order[i]];
            corner[i + 1] = at(c);
          }
          const Eigen::Vector3d a = mesh.V.row(corner[0]), b = mesh.V.row(corner[1]), d = mesh.V.row(corner[2]),
                                e = mesh.V.row(corner[3]);
          if ((b - a).cross(d - a).dot(e - a) < 0) std::swap(corner[2], corner[3]);
          mesh.T.row(row++) << corner[0], corner[1], corner[2], corner[3];
        }
  mesh.region.assign(row, TetMesh::kSoft);
  return mesh;
}

// Returns the tets of all cubes of `side`^3 voxels that contain tissue. `regions` has 0 for air, 1 for soft tissue, and
// 2 or more for bones. All tets of a cube get the region that most of its tissue voxels have.
inline TetMesh kuhn_mesh_of(const LabelVolume& regions, int side) {
  const glm::ivec3 cubes = (regions.grid.size + side - 1) / side;
  TetMesh mesh = kuhn_mesh(regions.grid, glm::dvec3(-0.5), glm::dvec3(cubes * side) - 0.5, cubes);
  std::vector<int> kept_tets, place(mesh.V.rows(), -1);
  std::vector<std::uint16_t> region;
  for (int c = 0; c < cubes.x * cubes.y * cubes.z; ++c) {
    const glm::ivec3 first = glm::ivec3(c % cubes.x, c / cubes.x % cubes.y, c / cubes.x / cubes.y) * side;
    std::map<Label, int> counts;
    for (int i = 0; i < side * side * side; ++i)
      if (const Label label = regions.at_or_air(first + glm::ivec3(i % side, i / side % side, i / side / side)))
        ++counts[label];
    if (counts.empty()) continue;
    const auto most = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
                        return a.second < b.second;
                      })->first;
    for (int t = 0; t < 6; ++t) {
      kept_tets.push_back(6 * c + t);
      region.push_back(static_cast<std::uint16_t>(most - 1));
    }
  }
  TetMesh kept;
  std::vector<int> nodes;
  kept.T.resize(std::ssize(kept_tets), 4);
  for (size_t t = 0; t < kept_tets.size(); ++t)
    for (int i = 0; i < 4; ++i) {
      int& at = place[mesh.T(kept_tets[t], i)];
      if (at < 0) {
        at = static_cast<int>(nodes.size());
        nodes.push_back(mesh.T(kept_tets[t], i));
      }
      kept.T(t, i) = at;
    }
  kept.V.resize(std::ssize(nodes), 3);
  for (size_t n = 0; n < nodes.size(); ++n) kept.V.row(n) = mesh.V.row(nodes[n]);
  kept.region = region;
  return kept;
}

}  // namespace limber::test
