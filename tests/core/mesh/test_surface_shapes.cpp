// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/surface_shapes.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "tests/support/closed_surface.h"

using namespace limber;
using namespace limber::test;

namespace {
double longest_edge(const TriangleMesh& mesh) {
  double longest = 0;
  for (const glm::ivec3& f : mesh.F)
    for (int i = 0; i < 3; ++i) longest = std::max(longest, glm::length(mesh.V[f[i]] - mesh.V[f[(i + 1) % 3]]));
  return longest;
}

void check_extent(const TriangleMesh& mesh, const glm::dvec3& half) {
  glm::dvec3 low(1e300), high(-1e300);
  for (const glm::dvec3& v : mesh.V) low = glm::min(low, v), high = glm::max(high, v);
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(low[axis] == doctest::Approx(-half[axis]));
    CHECK(high[axis] == doctest::Approx(half[axis]));
  }
}

// Checks that every vertex is used and that no two are at one position: adjacent sides of a box share vertices.
void check_vertices(const TriangleMesh& mesh) {
  std::vector<bool> used(mesh.V.size());
  for (const glm::ivec3& f : mesh.F)
    for (int i = 0; i < 3; ++i) used[f[i]] = true;
  CHECK(std::all_of(used.begin(), used.end(), [](bool b) { return b; }));
  std::vector<glm::dvec3> sorted = mesh.V;
  const auto before = [](const glm::dvec3& a, const glm::dvec3& b) {
    return std::pair(a.x, std::pair(a.y, a.z)) < std::pair(b.x, std::pair(b.y, b.z));
  };
  std::sort(sorted.begin(), sorted.end(), before);
  CHECK(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end());
}
}  // namespace

TEST_CASE("surface shapes: a box is closed, outward, of its size, and of short edges") {
  for (const glm::dvec3& size : {glm::dvec3(100, 60, 20), glm::dvec3(1, 1, 1), glm::dvec3(1000, 10, 500)}) {
    const TriangleMesh box = box_surface(size);
    CHECK(open_edges(box) == 0);
    CHECK(volume_inside(box) == doctest::Approx(size.x * size.y * size.z));
    check_extent(box, size / 2.0);
    check_vertices(box);
    CHECK(longest_edge(box) <= std::min(std::max({size.x, size.y, size.z}) / 10, 20.0) * (1 + 1e-9));
  }
}

TEST_CASE("surface shapes: a cylinder is closed and outward, with its vertices on the true one") {
  for (const glm::dvec2& shape : {glm::dvec2(50, 300), glm::dvec2(400, 20), glm::dvec2(2, 900), glm::dvec2(0.5, 0.1)}) {
    const double radius = shape[0], length = shape[1];
    const TriangleMesh cylinder = cylinder_surface(radius, length);
    CAPTURE(radius);
    CHECK(open_edges(cylinder) == 0);
    const double exact = std::numbers::pi * radius * radius * length, volume = volume_inside(cylinder);
    CHECK(volume < exact);
    CHECK(volume > 0.993 * exact);
    check_extent(cylinder, {radius, radius, length / 2});
    check_vertices(cylinder);
    for (const glm::ivec3& f : cylinder.F) {
      const glm::dvec3 &a = cylinder.V[f.x], &b = cylinder.V[f.y], &c = cylinder.V[f.z],
                       normal = glm::cross(b - a, c - a), middle = (a + b + c) / 3.0;
      const bool is_end = a.z == b.z && b.z == c.z;
      CHECK((is_end ? normal.z * middle.z : glm::dot(glm::dvec2(normal), glm::dvec2(middle))) > 0);
    }
    CHECK(longest_edge(cylinder) <= std::min(std::max(2 * radius, length) / 10, 20.0) * (1 + 1e-9));
  }
}

TEST_CASE("surface shapes: a tube is open at both ends and faces away from its axis") {
  const TriangleMesh tube = cylinder_surface(60, 120, CylinderEnds::Open);
  int at_ends = 0;
  for (const glm::dvec3& v : tube.V) {
    CHECK(glm::length(glm::dvec2(v)) == doctest::Approx(60));
    at_ends += std::abs(v.z) == 60;
  }
  CHECK(open_edges(tube) == at_ends);
  for (const glm::ivec3& f : tube.F) {
    const glm::dvec3 normal = glm::cross(tube.V[f.y] - tube.V[f.x], tube.V[f.z] - tube.V[f.x]);
    CHECK(glm::dot(glm::dvec2(normal), glm::dvec2(tube.V[f.x])) > 0);
  }
}

TEST_CASE("surface shapes: a plane is open, faces up and has its area") {
  const TriangleMesh plane = plane_surface(300, 100);
  double area = 0;
  for (const glm::ivec3& f : plane.F) {
    const glm::dvec3 normal = glm::cross(plane.V[f.y] - plane.V[f.x], plane.V[f.z] - plane.V[f.x]);
    CHECK(normal.z > 0);
    area += normal.z / 2;
  }
  CHECK(area == doctest::Approx(30000));
  CHECK(open_edges(plane) > 0);
  check_extent(plane, {150, 50, 0});
  check_vertices(plane);
  CHECK(longest_edge(plane) <= 20 * (1 + 1e-9));
}

TEST_CASE("surface shapes: huge and lopsided shapes stay within their number of triangles") {
  CHECK(box_surface({1e6, 1e6, 1e6}).F.size() <= kMostShapeTriangles);
  CHECK(box_surface({1e6, 0.001, 0.001}).F.size() <= kMostShapeTriangles);
  CHECK(plane_surface(1e6, 1e6).F.size() <= kMostShapeTriangles);
  for (const CylinderEnds ends : {CylinderEnds::Closed, CylinderEnds::Open})
    for (const glm::dvec2& shape : {glm::dvec2(1e6, 1e6), glm::dvec2(1e6, 0.001), glm::dvec2(0.001, 1e6)})
      CHECK(cylinder_surface(shape[0], shape[1], ends).F.size() <= kMostShapeTriangles);
}

TEST_CASE("surface shapes: an extent that is no length is refused") {
  for (const double bad :
       {0.0, -1.0, 1e7, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    CHECK_THROWS_AS(box_surface({10, bad, 10}), Error);
    CHECK_THROWS_AS(cylinder_surface(bad, 10), Error);
    CHECK_THROWS_AS(cylinder_surface(10, bad, CylinderEnds::Open), Error);
    CHECK_THROWS_AS(plane_surface(bad, 10), Error);
  }
}
