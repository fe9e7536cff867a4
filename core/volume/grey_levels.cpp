// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/grey_levels.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"

namespace limber {

namespace {

// Calls body(row) for each row y + size.y * z of a grid, on several threads.
template <class Body>
void for_each_row(const glm::ivec3& size, const Body& body) {
  parallel_for(std::int64_t{size.y} * size.z, 64, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t row = begin; row < end; ++row) body(row);
  });
}

std::array<std::uint16_t, 2> range_of_block(const GreyLevels& image, const glm::ivec3& block) {
  const glm::ivec3 low = glm::max(block * GreyLevels::kBlock - 1, glm::ivec3(0)),
                   high = glm::min((block + 1) * GreyLevels::kBlock, image.grid.size - 1);
  std::array<std::uint16_t, 2> range{65535, 0};
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y) {
      const std::uint16_t* row = &image.levels[static_cast<std::size_t>(image.grid.index({0, y, z}))];
      for (int x = low.x; x <= high.x; ++x) {
        range[0] = std::min(range[0], row[x]);
        range[1] = std::max(range[1], row[x]);
      }
    }
  return range;
}

void find_ranges(GreyLevels& image) {
  const glm::ivec3 blocks = image.blocks();
  image.ranges.resize(static_cast<std::size_t>(blocks.x) * blocks.y * blocks.z);
  for_each_row(blocks, [&](std::int64_t row) {
    for (int x = 0; x < blocks.x; ++x)
      image.ranges[static_cast<std::size_t>(x + row * blocks.x)] =
          range_of_block(image, {x, static_cast<int>(row % blocks.y), static_cast<int>(row / blocks.y)});
  });
}

}  // namespace

GreyLevels grey_levels(const Grid& grid, std::span<const float> values) {
  GreyLevels image;
  image.grid = grid;
  float least = INFINITY, most = -INFINITY;
  for (const float value : values)
    if (std::isfinite(value)) least = std::min(least, value), most = std::max(most, value);
  if (!(least <= most)) least = most = 0;
  image.least = least;
  image.step = most > least ? (double(most) - least) / 65535 : 1;
  image.levels.resize(values.size());
  const double levels_per_unit = 1 / image.step;
  for_each_row(grid.size, [&](std::int64_t row) {
    const std::int64_t first = row * grid.size.x;
    for (std::int64_t i = first; i < first + grid.size.x; ++i) {
      const float value = values[static_cast<std::size_t>(i)];
      image.levels[static_cast<std::size_t>(i)] =
          std::isfinite(value) ? static_cast<std::uint16_t>((double(value) - image.least) * levels_per_unit + 0.5) : 0;
    }
  });
  find_ranges(image);
  return image;
}

GreyLevels halved(const GreyLevels& image) {
  GreyLevels half;
  half.grid = image.grid;
  half.grid.size = (image.grid.size + 1) / 2;
  half.grid.spacing = image.grid.spacing * 2.0;
  half.grid.origin = world_from_voxel(image.grid) * glm::dvec3(0.5);
  half.least = image.least;
  half.step = image.step;
  half.levels.resize(static_cast<std::size_t>(half.grid.voxel_count()));
  for_each_row(half.grid.size, [&](std::int64_t row) {
    const glm::ivec3 start(0, row % half.grid.size.y, row / half.grid.size.y);
    for (int x = 0; x < half.grid.size.x; ++x) {
      const glm::ivec3 low = 2 * glm::ivec3(x, start.y, start.z), high = glm::min(low + 2, image.grid.size);
      std::uint32_t sum = 0, count = 0;
      for (int z = low.z; z < high.z; ++z)
        for (int y = low.y; y < high.y; ++y)
          for (int i = low.x; i < high.x; ++i, ++count)
            sum += image.levels[static_cast<std::size_t>(image.grid.index({i, y, z}))];
      half.levels[static_cast<std::size_t>(half.grid.index({x, start.y, start.z}))] =
          static_cast<std::uint16_t>((sum + count / 2) / count);
    }
  });
  find_ranges(half);
  return half;
}

std::array<double, 2> usual_window(const GreyLevels& image) {
  std::vector<std::int64_t> counts(65536);
  for (const std::uint16_t level : image.levels) ++counts[level];
  const auto quantile = [&](double share) {
    const auto wanted = static_cast<std::int64_t>(share * double(image.levels.size()));
    std::int64_t seen = 0;
    for (int level = 0; level < 65536; ++level)
      if ((seen += counts[static_cast<std::size_t>(level)]) > wanted)
        return image.value_of(static_cast<std::uint16_t>(level));
    return image.most();
  };
  const double low = quantile(0.01), high = quantile(0.99);
  return {(low + high) / 2, high > low ? high - low : 1};
}

}  // namespace limber
