// SPDX-License-Identifier: AGPL-3.0-or-later
#include <doctest/doctest.h>

#include "core/mesh/split_at_seams.h"
#include "tests/support/kuhn_mesh.h"

using namespace limber;

namespace {

// Adds a cube of 6^3 voxels whose lowest corner is at (x, 1, 1).
void add_cube(TetMesh& mesh, const Grid& grid, double x, std::uint16_t region) {
  const TetMesh cube = test::kuhn_mesh(grid, {x, 1, 1}, {x + 6, 7, 7}, glm::ivec3(1));
  const int nodes = int(mesh.V.rows());
  mesh.V.conservativeResize(nodes + cube.V.rows(), 3);
  mesh.V.bottomRows(cube.V.rows()) = cube.V;
  mesh.T.conservativeResize(mesh.T.rows() + cube.T.rows(), 4);
  mesh.T.bottomRows(cube.T.rows()) = cube.T.array() + nodes;
  mesh.region.insert(mesh.region.end(), cube.T.rows(), region);
}

}  // namespace

TEST_CASE("flakes in the air are removed from a mesh, parts with bone or with tissue are not") {
  const Grid grid{.size = {80, 10, 10}, .spacing = glm::dvec3(3)};
  LabelVolume body{grid, ZeroedVector<Label>(grid.voxel_count())};
  for (int z = 0; z < 10; ++z)
    for (int y = 0; y < 10; ++y)
      for (int x = 0; x < 22; ++x) body.at({x, y, z}) = 1;
  const TissueVoxels tissue(body);
  const std::vector<std::uint16_t> region(tissue.size(), TetMesh::kSoft);
  TetMesh mesh;
  add_cube(mesh, grid, 1, TetMesh::kSoft);     // in tissue
  add_cube(mesh, grid, 20.2, soft_region(1));  // most of it in air
  add_cube(mesh, grid, 40, 1);                 // bone in air
  add_cube(mesh, grid, 60, TetMesh::kSoft);    // in air
  const auto nodes = mesh.V.rows();
  CHECK(remove_flakes(mesh, {grid, tissue, region}) == 12);
  REQUIRE(mesh.T.rows() == 12);
  CHECK(mesh.V.rows() == nodes);
  CHECK(std::count(mesh.region.begin(), mesh.region.end(), TetMesh::kSoft) == 6);
  CHECK(std::count(mesh.region.begin(), mesh.region.end(), 1) == 6);
  for (const int node : mesh.T.topRows(6).reshaped()) CHECK(mesh.V(node, 0) <= 3 * 7 + 1e-9);
  CHECK(remove_flakes(mesh, {grid, tissue, region}) == 0);
}
