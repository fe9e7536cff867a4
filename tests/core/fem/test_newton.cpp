// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/newton.h"

#include <numeric>

#include <doctest/doctest.h>

#include "tests/support/tet_shapes.h"

using namespace limber;

TEST_CASE("newton: flesh that hardly anything holds is not sent further than half the body's extent in one step") {
  // Two boxes, one above the other, whose skins barely touch. The upper box is free, and a force lifts it: only the
  // barrier between the skins, which has almost no curvature there, holds it.
  const TetMesh box = kuhn_box(2, 2, 2, {0, 0, 0}, {8, 8, 8});
  const int nodes = int(box.V.rows());
  NodePositions rest(2 * nodes, 3);
  rest << box.V, box.V.rowwise() + Eigen::RowVector3d(0.7, 0.4, 8 + 6.0);
  Eigen::MatrixX4i T(2 * box.T.rows(), 4);
  T << box.T, box.T.array() + nodes;
  FemEnergy energy(rest, T, std::vector<TetMaterial>(T.rows(), {2, 0.4}), 0);
  std::vector<int> lower(nodes);
  std::iota(lower.begin(), lower.end(), 0);
  energy.set_constraints({}, lower, rest.topRows(nodes));
  energy.set_contact({boundary_of(T), rest, std::vector<int>(rest.rows(), -1), {.thickness_mm = 2}});
  NodePositions load = NodePositions::Zero(rest.rows(), 3);
  load.bottomRows(nodes).col(2).setConstant(5);
  energy.set_load(load);
  NodePositions x = rest;
  x.bottomRows(nodes).col(2).array() -= 6 - 1.9999;  // the skins begin to touch at 2 mm
  energy.build_broad_phase(x);

  NodePositions step;
  double slope = 0;
  REQUIRE(energy.newton_step(x, HessianKind::Projected, step, slope));
  REQUIRE(energy.tightest() < 1);
  const double extent = (x.colwise().maxCoeff() - x.colwise().minCoeff()).norm();
  REQUIRE(step.rowwise().norm().maxCoeff() > 2 * extent);  // the undamped step would fly away
  std::vector<double> moved;
  minimise(energy, x, {.tolerance_mm = 1e-3, .iterations = 3}, no_progress(),
           [&](int, double residual) { moved.push_back(residual); });
  REQUIRE(!moved.empty());
  CHECK(moved.front() < 0.5 * extent);
}
