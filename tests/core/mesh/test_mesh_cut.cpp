// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/mesh_cut.h"

#include <map>
#include <set>

#include <doctest/doctest.h>

#include "tests/support/tet_shapes.h"

using namespace limber;

TEST_CASE("mesh cut: every face is there once") {
  const TetMesh box = kuhn_box(3, 2, 4, {0, 0, 0}, {3, 2, 4});
  const Eigen::MatrixX3i F = faces_of(box.T);
  std::set<std::set<int>> once;
  for (const auto& f : F.rowwise()) once.insert({f[0], f[1], f[2]});
  CHECK(std::ssize(once) == F.rows());
  CHECK(2 * F.rows() == 4 * box.T.rows() + boundary_of(box.T).rows());
}

TEST_CASE(
    "mesh cut: the lines of a plane lie in it, close around each tet, and their border has the length of the "
    "section's") {
  const TetMesh box = kuhn_box(5, 4, 6, {-5, -4, -6}, {5, 4, 6});
  const glm::dvec3 point(0.13, -0.2, 0.31);
  for (const glm::dvec3 normal : {glm::dvec3(0, 0, 2), glm::dvec3(1, 0, 0), glm::normalize(glm::dvec3(1, 2, 3))}) {
    const auto lines = plane_cut(box.V, faces_of(box.T), point, normal);
    REQUIRE(lines.size() > 50);
    std::map<std::array<long, 3>, int> ends;
    for (const Segment& line : lines)
      for (const glm::dvec3& end : line) {
        CHECK(std::abs(glm::dot(end - point, normal)) < 1e-12);
        ++ends[{std::lround(end.x * 1e9), std::lround(end.y * 1e9), std::lround(end.z * 1e9)}];
      }
    for (const auto& [place, lines_there] : ends) CHECK(lines_there >= 2);  // every line continues at both ends
  }
  double border = 0;
  for (const Segment& line : plane_cut(box.V, boundary_of(box.T), point, {0, 0, 1}))
    border += glm::distance(line[0], line[1]);
  CHECK(border == doctest::Approx(2 * (10 + 8)));
}

TEST_CASE("mesh cut: a plane through nodes draws each line once") {
  const TetMesh box = kuhn_box(2, 2, 2, {0, 0, 0}, {2, 2, 2});
  double length = 0;
  for (const Segment& line : plane_cut(box.V, boundary_of(box.T), {1, 1, 1}, {0, 0, 1}))
    length += glm::distance(line[0], line[1]);
  CHECK(length == doctest::Approx(8));
}

TEST_CASE("mesh cut: what lies before another plane is cut off") {
  std::vector<Segment> lines{
      {{{0, 0, 0}, {2, 0, 0}}}, {{{3, 0, 0}, {4, 0, 0}}}, {{{2, 5, 0}, {-2, 5, 0}}}, {{{0, 1, 0}, {1, 1, 0}}}};
  keep_behind(lines, {1, 0, 0}, {1, 0, 0});
  REQUIRE(lines.size() == 3);
  CHECK(lines[0][1] == glm::dvec3(1, 0, 0));
  CHECK(lines[1][0] == glm::dvec3(1, 5, 0));
  CHECK(lines[2][1] == glm::dvec3(1, 1, 0));
}
