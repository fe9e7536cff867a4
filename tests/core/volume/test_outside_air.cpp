// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/outside_air.h"

#include <algorithm>
#include <random>

#include <doctest/doctest.h>

using namespace limber;

namespace {
int sides_of(const glm::ivec3& v, const glm::ivec3& size) {
  int sides = 0;
  for (int axis = 0; axis < 3; ++axis) sides += v[axis] == 0 || v[axis] == size[axis] - 1;
  return sides;
}

// Floods air voxel by voxel from all voxels that lie at `sides` or more faces of the grid.
std::vector<std::uint8_t> flooded(const LabelVolume& volume, int sides) {
  std::vector<std::uint8_t> outside(volume.voxels.size(), 0);
  std::vector<glm::ivec3> open;
  const auto add = [&](const glm::ivec3& v) {
    if (!volume.grid.contains(v) || volume.at(v) != 0 || outside[volume.grid.index(v)]) return;
    outside[volume.grid.index(v)] = 1;
    open.push_back(v);
  };
  for (int z = 0; z < volume.grid.size.z; ++z)
    for (int y = 0; y < volume.grid.size.y; ++y)
      for (int x = 0; x < volume.grid.size.x; ++x)
        if (sides_of({x, y, z}, volume.grid.size) >= sides) add({x, y, z});
  while (!open.empty()) {
    const glm::ivec3 v = open.back();
    open.pop_back();
    for (int axis = 0; axis < 3; ++axis)
      for (const int step : {-1, 1}) {
        glm::ivec3 w = v;
        w[axis] += step;
        add(w);
      }
  }
  return outside;
}
}  // namespace

TEST_CASE("outside air: boxes of tissue with holes, free or against any sides, give what a plain flood gives") {
  std::mt19937 random(4);
  for (int round = 0; round < 300; ++round) {
    LabelVolume volume;
    volume.grid.size = {2 + int(random() % 20), 2 + int(random() % 9), 2 + int(random() % 9)};
    volume.voxels.assign(volume.grid.voxel_count(), 0);
    glm::ivec3 low, high;
    for (int axis = 0; axis < 3; ++axis) {
      const int size = volume.grid.size[axis];
      low[axis] = random() % 3 == 0 ? 0 : int(random() % size);
      high[axis] = random() % 3 == 0 ? size - 1 : low[axis] + int(random() % (size - low[axis]));
    }
    const unsigned air = random() % 4;  // share of air, in fifths
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) volume.at({x, y, z}) = random() % 5 >= air ? 1 : 0;
    std::vector<std::uint8_t> expected = flooded(volume, 2);
    if (std::count(expected.begin(), expected.end(), 1) == 0) expected = flooded(volume, 1);
    CHECK(outside_air(volume) == expected);
  }
}
