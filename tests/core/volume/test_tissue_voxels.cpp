// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/tissue_voxels.h"

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/base/parallel.h"

using namespace limber;

TEST_CASE("tissue voxels: a volume longer than positions of 16 bits reach is refused in a sentence") {
  for (int axis = 0; axis < 3; ++axis) {
    LabelVolume volume;
    volume.grid.size = {1, 1, 1};
    volume.grid.size[axis] = 32767;
    volume.voxels.assign(volume.grid.voxel_count(), 1);
    CHECK(TissueVoxels(volume).size() == 32767);
    volume.grid.size[axis] = 32768;
    volume.voxels.assign(volume.grid.voxel_count(), 1);
    CHECK_THROWS_WITH_AS(TissueVoxels{volume}, doctest::Contains("32768 voxels long"), Error);
  }
}

TEST_CASE("tissue voxels: every voxel stands once, brick by brick, with any number of threads") {
  LabelVolume volume;
  volume.grid.size = {19, 9, 41};
  volume.voxels.assign(volume.grid.voxel_count(), 0);
  for (std::int64_t i = 0; i < std::ssize(volume.voxels); ++i) volume.voxels[i] = i * 7919 % 11 < 4 && i % 2000 > 300;
  std::vector<glm::ivec3> expected;
  const glm::ivec3 bricks = (volume.grid.size + 7) / 8;
  for (int brick = 0; brick < bricks.x * bricks.y * bricks.z; ++brick)
    for (int bit = 0; bit < 512; ++bit) {
      const glm::ivec3 corner =
          8 * glm::ivec3(brick % bricks.x, brick / bricks.x % bricks.y, brick / bricks.x / bricks.y);
      const glm::ivec3 voxel = corner + glm::ivec3(bit & 7, bit >> 3 & 7, bit >> 6);
      if (volume.at_or_air(voxel) != 0) expected.push_back(voxel);
    }
  for (const int threads : {1, 2, 4}) {
    const ThreadCount count(threads);
    const TissueVoxels tissue(volume);
    std::vector<glm::ivec3> found;
    bool is_found_again = true;
    tissue.for_each([&](std::int64_t place, const glm::ivec3& voxel) {
      is_found_again = is_found_again && place == std::ssize(found) && tissue.index_of(voxel) == place;
      found.push_back(voxel);
    });
    CHECK(found == expected);
    CHECK(is_found_again);
  }
}
