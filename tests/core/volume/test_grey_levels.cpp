// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/grey_levels.h"

#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "core/base/parallel.h"

using namespace limber;

namespace {

// Noise on a ramp, with values from -1000 to 2000, on an oblique grid whose size is not a multiple of a block.
struct Noise {
  Grid grid{{37, 21, 19}, {0.7, 1, 2}, {5, -3, 11}, glm::dmat3(1)};
  std::vector<float> values;

  Noise() {
    std::mt19937 random(7);
    for (std::int64_t i = 0; i < grid.voxel_count(); ++i)
      values.push_back(static_cast<float>(-1000 + 3000.0 * double(random() % 10000) / 9999));
  }
};

}  // namespace

TEST_CASE("grey levels: each value is kept to half a level, and a value that is no number becomes the least") {
  Noise noise;
  noise.values[5] = std::numeric_limits<float>::quiet_NaN();
  noise.values[6] = std::numeric_limits<float>::infinity();
  const GreyLevels image = grey_levels(noise.grid, noise.values);
  CHECK(image.step == doctest::Approx(3000.0 / 65535).epsilon(0.01));
  for (std::size_t i = 0; i < noise.values.size(); ++i) {
    const double value = image.value_of(image.levels[i]);
    if (std::isfinite(noise.values[i])) CHECK(std::abs(value - double(noise.values[i])) <= image.step * 0.51);
    else CHECK(value == image.least);
  }
  const ThreadCount one(1);
  CHECK(grey_levels(noise.grid, noise.values).levels == image.levels);
}

TEST_CASE("grey levels: a constant image, and one without voxels, have no range and no trouble") {
  const Grid grid{{3, 4, 5}, glm::dvec3(1), glm::dvec3(0), glm::dmat3(1)};
  const std::vector<float> same(60, 42.0f);
  const GreyLevels image = grey_levels(grid, same);
  CHECK(image.value_at({1, 2, 3}) == 42);
  CHECK(usual_window(image)[1] > 0);
  const GreyLevels none = grey_levels({glm::ivec3(0), glm::dvec3(1), glm::dvec3(0), glm::dmat3(1)}, {});
  CHECK(none.levels.empty());
  CHECK(usual_window(none)[1] > 0);
}

TEST_CASE("grey levels: no value interpolated in a block is outside the block's range") {
  const Noise noise;
  const GreyLevels image = grey_levels(noise.grid, noise.values);
  std::mt19937 random(11);
  const auto coordinate = [&](int size) { return double(random() % 100000) / 100000 * size; };
  for (int i = 0; i < 20000; ++i) {
    // In the shader's coordinates, voxel v covers [v, v + 1) and has its centre at v + 1/2.
    const glm::dvec3 p(coordinate(37), coordinate(21), coordinate(19));
    const glm::ivec3 block = glm::ivec3(p) / GreyLevels::kBlock, blocks = image.blocks();
    const auto& range = image.ranges[static_cast<std::size_t>(block.x + blocks.x * (block.y + blocks.y * block.z))];
    double value = 0;
    const glm::dvec3 low = glm::floor(p - 0.5), t = p - 0.5 - low;
    for (int k = 0; k < 8; ++k) {
      const glm::ivec3 corner(k & 1, k >> 1 & 1, k >> 2);
      const glm::ivec3 v = glm::clamp(glm::ivec3(low) + corner, glm::ivec3(0), noise.grid.size - 1);
      const glm::dvec3 share = glm::mix(1.0 - t, t, glm::dvec3(corner));
      value += share.x * share.y * share.z * image.levels[static_cast<std::size_t>(noise.grid.index(v))];
    }
    CHECK_MESSAGE((value >= range[0] - 1e-6 && value <= range[1] + 1e-6), "point " << p.x << " " << p.y << " " << p.z);
  }
}

TEST_CASE("grey levels: half the resolution has the means of eight voxels at their middle") {
  const Noise noise;
  const GreyLevels image = grey_levels(noise.grid, noise.values), half = halved(image);
  CHECK(half.grid.size == glm::ivec3(19, 11, 10));
  const glm::dvec3 middle = world_from_voxel(image.grid) * (glm::dvec3(4, 6, 8) + 0.5);
  CHECK(glm::distance(world_from_voxel(half.grid) * glm::dvec3(2, 3, 4), middle) < 1e-9);
  double sum = 0;
  for (int k = 0; k < 8; ++k) sum += image.value_at(glm::ivec3(4, 6, 8) + glm::ivec3(k & 1, k >> 1 & 1, k >> 2));
  CHECK(half.value_at({2, 3, 4}) == doctest::Approx(sum / 8).epsilon(1e-3));
}
