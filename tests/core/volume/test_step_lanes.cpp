// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/step_lanes.h"

#include <algorithm>
#include <random>

#include <doctest/doctest.h>

using namespace limber;

TEST_CASE("step lanes: sums stop at 65 535, minima and comparisons are those of whole numbers") {
  std::mt19937 random(12);
  const int ends[] = {0, 1, 32767, 32768, 65534, 65535};
  const auto number = [&] { return static_cast<std::uint16_t>(random() % 3 ? ends[random() % 6] : random()); };
  for (int round = 0; round < 3000; ++round) {
    StepLanes<2> lanes, other;
    for (int i = 0; i < 16; ++i) lanes[i / 8][i % 8] = number(), other[i / 8][i % 8] = number();
    const std::uint16_t rise = number();
    bool above = false, below = false;
    StepLanes<2> least;
    for (int i = 0; i < 16; ++i) {
      const int mine = lanes[i / 8][i % 8], raised = std::min(other[i / 8][i % 8] + rise, 65535);
      above |= mine > rise;
      below |= raised < mine;
      least[i / 8][i % 8] = static_cast<std::uint16_t>(std::min(mine, raised));
    }
    CHECK(any_above(lanes, rise) == above);
    CHECK(any_lower(other, rise, lanes) == below);
    lower(lanes, other, rise);
    for (int i = 0; i < 16; ++i) CHECK(lanes[i / 8][i % 8] == least[i / 8][i % 8]);
  }
}
