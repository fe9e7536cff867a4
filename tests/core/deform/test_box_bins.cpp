// SPDX-License-Identifier: AGPL-3.0-or-later
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
