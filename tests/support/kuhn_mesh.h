// SPDX-License-Identifier: AGPL-3.0-or-later
// A box of tets for tests: a lattice of cubes, each split into six around its main diagonal [Kuhn 1960].
#pragma once

#include <array>

#include <Eigen/Geometry>
#include <glm/glm.hpp>

#include "core/mesh/tet_mesh.h"
#include "core/volume/grid.h"

namespace limber::test {

//   low, high  corners of the box, voxel coordinates of `grid`; cubes along each axis
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
  constexpr std::array<std::array<int, 3>, 6> kOrders{{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}}};
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
          const Eigen::Vector3d a = mesh.V.row(corner[0]), b = mesh.V.row(corner[1]), d = mesh.V.row(corner[2]), e = mesh.V.row(corner[3]);
          if ((b - a).cross(d - a).dot(e - a) < 0) std::swap(corner[2], corner[3]);
          mesh.T.row(row++) << corner[0], corner[1], corner[2], corner[3];
        }
  mesh.region.assign(row, TetMesh::kSoft);
  return mesh;
}

}  // namespace limber::test
