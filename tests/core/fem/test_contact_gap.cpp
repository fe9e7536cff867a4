// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/contact_gap.h"

#include <doctest/doctest.h>

#include "core/mesh/tet_mesh.h"
#include "tests/support/kuhn_mesh.h"

using namespace limber;

namespace {

// Two boxes with edges of 10 mm. The second lies `gap` mm above the first and `aside` mm beside it.
struct TwoBoxes {
  Eigen::MatrixX3d rest, V;
  Eigen::MatrixX3i F;

  TwoBoxes(double gap, double aside = 0.3) {
    const TetMesh box = test::kuhn_mesh({}, glm::dvec3(0), glm::dvec3(10), {3, 3, 3});
    const Eigen::MatrixX3i border = boundary_of(box.T);
    const auto nodes = box.V.rows(), faces = border.rows();
    V.resize(2 * nodes, 3);
    V.topRows(nodes) = box.V;
    V.bottomRows(nodes) = box.V.rowwise() + Eigen::RowVector3d(aside, 0.4 * aside, 10 + gap);
    rest = V;
    rest.bottomRows(nodes).col(2).array() += 100;
    F.resize(2 * faces, 3);
    F.topRows(faces) = border;
    F.bottomRows(faces) = border.array() + int(nodes);
  }
};

}  // namespace

TEST_CASE("contact gap: it is the air between parts that face each other, and nothing where none do") {
  const TwoBoxes near(1.25);
  const auto gap = contact_gap(near.rest, near.V, near.F, 20, 5);
  REQUIRE(gap);
  CHECK(gap->smallest_mm == doctest::Approx(1.25));
  CHECK(gap->median_mm == doctest::Approx(1.25).epsilon(0.1));
  CHECK(gap->nodes >= 18);
  CHECK_FALSE(contact_gap(near.rest, near.V, near.F, 20, 1));
  CHECK_FALSE(contact_gap(near.V, near.V, near.F, 20, 5));  // parts that are near at rest are not counted
  CHECK_FALSE(contact_gap(near.rest, TwoBoxes(8).V, near.F, 20, 5));
}

TEST_CASE("contact gap: a node has none to a long triangle of its own, whichever way that faces") {
  Eigen::MatrixX3d V(7, 3);
  V << 0, 0, 0, 10, 0, 0, 0, 10, 0, -10, 0, 0, 0, -10, 0, 90, -1, -8, 90, 1, -8;
  Eigen::MatrixX3i F(5, 3);
  F << 0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 1, 0, 6, 5;
  CHECK_FALSE(contact_gap(V, V, F, 20, 5));
}
