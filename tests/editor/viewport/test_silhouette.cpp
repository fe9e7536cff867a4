// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/viewport/silhouette.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <doctest/doctest.h>

namespace limber::test {

using namespace editor;

namespace {

// Adds the triangles between two circles of one centre.
void add_ring(const glm::vec2& middle, float inner, float outer, std::vector<glm::vec2>& points,
              std::vector<glm::u32vec3>& corners) {
  constexpr int kParts = 60;
  const int first = static_cast<int>(points.size());
  for (int i = 0; i < kParts; ++i) {
    const double angle = 2 * std::numbers::pi * i / kParts;
    const glm::vec2 way(std::cos(angle), std::sin(angle));
    points.push_back(middle + inner * way);
    points.push_back(middle + outer * way);
    const int a = first + 2 * i, b = first + 2 * ((i + 1) % kParts);
    corners.push_back({a, a + 1, b});
    corners.push_back({b, a + 1, b + 1});
  }
}

double area_of(const std::vector<glm::vec2>& line) {
  double area = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const glm::dvec2 a = line[i], b = line[(i + 1) % line.size()];
    area += (a.x * b.y - a.y * b.x) / 2;
  }
  return area;
}

}  // namespace

TEST_CASE("silhouette: the outline of overlapping triangles encloses what they cover, holes the other way round") {
  std::vector<glm::vec2> points;
  std::vector<glm::u32vec3> corners;
  add_ring({150, 120}, 0, 80, points, corners);
  add_ring({330, 120}, 40, 80, points, corners);
  add_ring({330, 120}, 50, 80, points, corners);
  const Rect picture{{20, 10}, {500, 300}};
  const auto lines = silhouette(points, corners, picture, 2);
  REQUIRE(lines.size() == 3);
  double whole = 0, hole = 0;
  for (const auto& line : lines) {
    const double area = area_of(line);
    (area > 0 ? whole : hole) += area;
    for (const glm::vec2& p : line) {
      const float left = glm::distance(p, glm::vec2(150, 120)), right = glm::distance(p, glm::vec2(330, 120));
      CHECK(std::min({std::abs(left - 80), std::abs(right - 80), std::abs(right - 40)}) < 2.5f);
    }
  }
  CHECK(whole == doctest::Approx(2 * std::numbers::pi * 80 * 80).epsilon(0.03));
  CHECK(-hole == doctest::Approx(std::numbers::pi * 40 * 40).epsilon(0.06));
}

TEST_CASE("silhouette: nothing behind the eye counts, and what leaves the picture is closed along its border") {
  const float none = std::numeric_limits<float>::quiet_NaN();
  const Rect picture{{0, 0}, {200, 100}};
  CHECK(silhouette({{10, 10}, {90, 10}, {none, none}}, {{0, 1, 2}}, picture, 2).empty());
  CHECK(silhouette({{-90, 10}, {-10, 10}, {-50, 90}}, {{0, 1, 2}}, picture, 2).empty());
  const auto lines = silhouette({{-1e6f, -1e6f}, {1e6f, -1e6f}, {0, 1e6f}}, {{0, 1, 2}}, picture, 2);
  REQUIRE(lines.size() == 1);
  CHECK(area_of(lines[0]) == doctest::Approx(200 * 100).epsilon(0.02));
}

}  // namespace limber::test
