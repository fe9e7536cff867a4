// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/tissue_set.h"

#include <random>

#include <doctest/doctest.h>

using namespace limber;

TEST_CASE("tissue set: it spreads to what hangs together with it through faces, as a search voxel by voxel finds it") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    LabelVolume volume;
    volume.grid.size = {19 + int(seed), 17, 26};
    volume.voxels.resize(volume.grid.voxel_count());
    // The search starts at label 3 and may spread through 2 and 3, but not through 1. Shares near the percolation
    // threshold make long paths.
    for (Label& label : volume.voxels) {
      const unsigned draw = random() % 1000;
      label = draw < 50 ? 0 : draw < 640 ? 1 : draw < 997 ? 2 : 3;
    }
    const TissueVoxels tissue(volume);
    TissueSet within(tissue), reached(tissue);
    std::vector<glm::ivec3> open;
    std::vector<bool> expected(volume.grid.voxel_count());
    tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
      if (volume.at(v) >= 2) within.add(v);
      if (volume.at(v) != 3) return;
      reached.add(v);
      expected[volume.grid.index(v)] = true;
      open.push_back(v);
    });
    while (!open.empty()) {
      const glm::ivec3 v = open.back();
      open.pop_back();
      for (int direction = 0; direction < 6; ++direction) {
        glm::ivec3 w = v;
        w[direction >> 1] += direction & 1 ? 1 : -1;
        if (volume.at_or_air(w) < 2 || expected[volume.grid.index(w)]) continue;
        expected[volume.grid.index(w)] = true;
        open.push_back(w);
      }
    }
    reached.spread(within);
    std::int64_t wrong = 0, found = 0;
    tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
      wrong += reached.contains(v) != expected[volume.grid.index(v)];
      found += reached.contains(v);
    });
    CHECK(wrong == 0);
    CHECK(found > 50);
  }
}
