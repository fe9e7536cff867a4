// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/tissue_voxels.h"

#include <doctest/doctest.h>

#include "core/base/error.h"

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
