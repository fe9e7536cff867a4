// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/kept_corners.h"

#include <random>

#include <doctest/doctest.h>

using namespace limber;

namespace {

// Random corners between `low` and `low + extent`, and their bounding box.
struct Brick {
  KeptCorners::Corners corners;
  FixedBox box;
  Brick(std::mt19937& random, const FixedPoint& low, int extent) {
    for (FixedPoint& corner : corners)
      for (int axis = 0; axis < 3; ++axis)
        corner[axis] = low[axis] + static_cast<int>(random() % (static_cast<unsigned>(extent) + 1));
    corners[3] = low;
    corners[700] = low + extent;
    box = {low, low + extent};
  }
};

}  // namespace

TEST_CASE("kept corners: those of bricks that bend are read back exactly, unless they reach too far") {
  std::mt19937 random(8);
  const int largest = 32 * kFixedOne - 1;
  const std::vector<int> only_bone{-1, 4, -1, -1};
  KeptCorners kept(only_bone);
  const Brick far_below(random, FixedPoint(-31000 * kFixedOne), largest), small(random, FixedPoint(5, -7, 9), 70000),
      large(random, FixedPoint(0), largest + 1);
  kept.keep(0, far_below.box, far_below.corners);
  kept.keep(2, small.box, small.corners);
  kept.keep(3, large.box, large.corners);
  KeptCorners::Corners read;
  REQUIRE(kept.read(0, far_below.box, read));
  CHECK(read == far_below.corners);
  REQUIRE(kept.read(2, small.box, read));
  CHECK(read == small.corners);
  CHECK_FALSE(kept.read(1, small.box, read));
  CHECK_FALSE(kept.read(3, large.box, read));
}

TEST_CASE("kept corners: no more are kept than fit into the memory") {
  std::mt19937 random(10);
  const Brick brick(random, FixedPoint(0), 1000);
  KeptCorners kept({-1, -1, 2, -1, -1}, 3 * 5832 + 100);
  KeptCorners::Corners read;
  int count = 0;
  for (const int b : {0, 1, 3, 4}) {
    kept.keep(b, brick.box, brick.corners);
    count += kept.read(b, brick.box, read);
  }
  CHECK(count == 3);
}

TEST_CASE("kept corners: a brick that is not kept does not hold back its group, below zero too") {
  std::mt19937 random(11);
  KeptCorners kept({-1, -1});
  const Brick low(random, FixedPoint(-40 * kFixedOne), 1000);
  kept.keep(0, low.box, low.corners);
  kept.forget_below(-20);
  KeptCorners::Corners read;
  CHECK_FALSE(kept.read(0, low.box, read));
}

TEST_CASE("kept corners: they are forgotten only where all bricks of a group lie below") {
  std::mt19937 random(9);
  constexpr int kBricks = 200;
  KeptCorners kept(std::vector<int>(kBricks, -1));
  std::vector<Brick> bricks;
  for (int b = 0; b < kBricks; ++b) {
    bricks.emplace_back(random, FixedPoint(0, 0, 8 * b * kFixedOne), 8 * kFixedOne);
    kept.keep(b, bricks[b].box, bricks[b].corners);
  }
  KeptCorners::Corners read;
  for (int z = 0; z < 8 * kBricks + 16; z += 100) {
    kept.forget_below(z);
    int forgotten = 0;
    for (int b = 0; b < kBricks; ++b) {
      if (kept.read(b, bricks[b].box, read)) CHECK(read == bricks[b].corners);
      else ++forgotten;
    }
    CHECK(forgotten <= z / 8);
    CHECK(forgotten >= z / 8 - 34);
  }
  kept.forget_below(INT32_MAX);
  CHECK_FALSE(kept.read(kBricks - 1, bricks.back().box, read));
}
