// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/carried_points.h"

#include <doctest/doctest.h>

#include "core/base/rigid_transform.h"
#include "tests/support/bent_tube.h"
#include "tests/support/kuhn_mesh.h"

using namespace limber;

namespace {

// A block of 12 x 10 x 14 voxels on a mirrored and oblique grid, meshed in cubes of 2 voxels.
struct Block {
  Grid grid = test::oblique_grid();
  std::shared_ptr<const TetMesh> mesh =
      std::make_shared<const TetMesh>(test::kuhn_mesh(grid, glm::dvec3(4), glm::dvec3(16, 14, 18), {6, 5, 7}));
  AffineTransform world = world_from_voxel(grid), voxel = voxel_from_world(grid);

  template <class Motion>
  Eigen::MatrixX3d moved(const Motion& motion) const {
    Eigen::MatrixX3d V = mesh->V;
    for (Eigen::Index v = 0; v < V.rows(); ++v) {
      const glm::dvec3 p = motion(glm::dvec3(V(v, 0), V(v, 1), V(v, 2)));
      V.row(v) << p.x, p.y, p.z;
    }
    return V;
  }
};

}  // namespace

TEST_CASE("carried points: those in and near a mesh turn with it as one body, those too far are not carried") {
  const Block block;
  std::vector<PointToCarry> points;
  for (const glm::dvec3& at :
       {glm::dvec3(9.3, 7.1, 12.9), glm::dvec3(4, 4, 4), glm::dvec3(2.5, 3, 12), glm::dvec3(17, 15, 19.5)})
    points.push_back({at, at});
  points.push_back({{40, 10, 10}, {40, 10, 10}});
  points.push_back({{40, 10, 10}, {10, 10, 10}});  // far from the mesh, but attached to its middle
  const double furthest = 4 * std::max({block.grid.spacing.x, block.grid.spacing.y, block.grid.spacing.z});
  const CarriedPoints carried(block.mesh, block.grid, points, furthest);
  const RigidTransform turn{glm::angleAxis(1.1, glm::normalize(glm::dvec3(1, 2, -1))), {20, -3, 8}};
  const auto posed = carried.posed(block.moved([&](const glm::dvec3& p) { return turn * p; }));
  REQUIRE(posed.size() == points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    CAPTURE(i);
    CHECK(posed[i].has_value() == (i != 4));
    if (posed[i]) CHECK(glm::distance(block.world * *posed[i], turn * (block.world * points[i].rest)) < 1e-9);
  }
  const auto still = carried.posed(block.mesh->V);
  for (const std::size_t i : {0, 1, 2, 3, 5}) CHECK(glm::distance(*still[i], points[i].rest) < 1e-12);
}

TEST_CASE("carried points: in a mesh that is stretched they keep their place in their tet") {
  const Block block;
  const glm::dvec3 inside(9.3, 7.1, 12.9), beside(17.5, 9, 11);
  const CarriedPoints carried(block.mesh, block.grid, {{inside, inside}, {beside, beside}}, 100);
  const glm::dvec3 along = block.grid.direction[0];
  const auto stretched = [&](const glm::dvec3& p) { return p + 0.5 * glm::dot(along, p) * along; };
  const auto posed = carried.posed(block.moved(stretched));
  CHECK(glm::distance(block.world * *posed[0], stretched(block.world * inside)) < 1e-9);
  // Outside the mesh nothing is stretched: the point keeps its distance of 1.5 voxels from the border.
  const glm::dvec3 border(16, 9, 11);
  CHECK(glm::distance(block.world * *posed[1],
                      stretched(block.world * border) + block.world.linear * (beside - border)) < 1e-9);
}
