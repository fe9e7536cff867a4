// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <random>

#include <doctest/doctest.h>

#include "core/deform/box_bins.h"

using namespace limber;

TEST_CASE("box bins find the boxes that meet a range, as a search of all boxes does") {
  std::mt19937 random(5);
  const auto number = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
  const auto any_box = [&](int longest) {
    const glm::ivec3 low(number(-90, 90), number(-90, 90), number(-90, 90));
    return VoxelRange{low, low + glm::ivec3(number(-1, longest), number(-1, longest), number(-1, longest))};
  };
  std::vector<VoxelRange> boxes;
  for (int i = 0; i < 300; ++i) boxes.push_back(any_box(i % 10 ? 12 : 150));
  for (int bin : {1, 8, 32, 1000}) {
    CAPTURE(bin);
    const BoxBins bins(boxes, bin);
    for (int asked = 0; asked < 100; ++asked) {
      const VoxelRange range = any_box(40);
      std::vector<std::int64_t> found, expected;
      bins.meeting(range, found);
      for (std::int64_t b = 0; b < std::ssize(boxes); ++b)
        if (!boxes[b].empty() && !range.empty() && !intersect(boxes[b], range).empty()) expected.push_back(b);
      CHECK(found == expected);
    }
  }
}

TEST_CASE("box bins of no boxes find nothing") {
  std::vector<int> found{1};
  BoxBins().meeting({glm::ivec3(0), glm::ivec3(9)}, found);
  CHECK(found.empty());
  BoxBins({VoxelRange{glm::ivec3(1), glm::ivec3(0)}}, 8).meeting({glm::ivec3(0), glm::ivec3(9)}, found);
  CHECK(found.empty());
}

TEST_CASE("point bins find every point within their reach, and none far away, in every unit of length") {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const double unit : {1e-3, 1.0, 1e4})
    for (const double reach : {0.02, 0.2, 3.0}) {
      CAPTURE(unit);
      CAPTURE(reach);
      std::vector<glm::dvec3> points;
      for (int i = 0; i < 500; ++i) points.push_back(unit * glm::dvec3(any(random), any(random), any(random)));
      const PointBins bins(points, unit * reach);
      std::vector<int> found;
      for (int asked = 0; asked < 50; ++asked) {
        const glm::dvec3 place = unit * glm::dvec3(any(random), any(random), any(random));
        bins.near(place, found);
        CHECK(std::is_sorted(found.begin(), found.end()));
        for (int i = 0; i < std::ssize(points); ++i) {
          const bool is_found = std::binary_search(found.begin(), found.end(), i);
          const double away = glm::distance(points[i], place) / unit;
          if (away < reach) CHECK(is_found);
          if (away > 3 * reach) CHECK(!is_found);
        }
      }
    }
}

TEST_CASE("point bins stay few if the points are far apart for their reach") {
  std::vector<int> found;
  const PointBins bins({glm::dvec3(-1e7), glm::dvec3(1e7), glm::dvec3(1e7 + 1e-6)}, 1e-5);
  bins.near(glm::dvec3(1e7), found);
  CHECK(found == std::vector<int>{1, 2});
  PointBins({}, 0).near(glm::dvec3(0), found);
  CHECK(found.empty());
}
