// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/label_edit/label_change.h"

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "tests/core/label_edit/random_labels.h"

using namespace limber;
using namespace limber::test;

TEST_CASE("label change: applied and taken back, it gives both volumes bit for bit") {
  const Grid grid{{17, 13, 11}};
  const LabelVolume before = random_labels(grid, 4, 1);
  LabelVolume after = before;
  for (const std::int64_t at : {0, 1, 2, 16, 17, 500, 501, 17 * 13 * 11 - 1})
    after.voxels[static_cast<std::size_t>(at)] = static_cast<Label>(9 + at % 2);
  const LabelChange change = label_difference(before, after);
  CHECK(change.voxel_count() == 8);
  CHECK(change.runs.size() == 4);  // 0 to 2; 16 and 17, which are in two rows; 500 and 501; the last voxel
  LabelVolume moved = before;
  apply_change(change, moved);
  CHECK(moved.voxels == after.voxels);
  take_back_change(change, moved);
  CHECK(moved.voxels == before.voxels);
  CHECK(label_difference(before, before).empty());
}

TEST_CASE("label change: its bounds hold every changed voxel and no more") {
  const Grid grid{{9, 8, 7}};
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    const LabelVolume before{grid, ZeroedVector<Label>(static_cast<std::size_t>(grid.voxel_count()))};
    LabelVolume after = before;
    const auto count = 1 + random() % 3;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = random() % after.voxels.size();
      for (std::size_t k = at; k < std::min(at + random() % 90, after.voxels.size()); ++k) after.voxels[k] = 1;
    }
    glm::ivec3 low(grid.size), high(-1);
    for_voxels(grid, [&](const glm::ivec3& v) {
      if (after.at(v)) low = glm::min(low, v), high = glm::max(high, v);
    });
    const LabelChange change = label_difference(before, after);
    const VoxelBox box = bounds_of(change, grid);
    if (high.x < 0) {
      CHECK(box.size.x == 0);
      continue;
    }
    CHECK(box.lowest == low);
    CHECK(box.size == high - low + 1);
    CHECK(label_box(after, 1).lowest == low);
    CHECK(label_box(after, 1).size == high - low + 1);
    CHECK(label_difference(before, after, box) == change);
  }
}

TEST_CASE("label change: it knows whether the same voxels stay tissue, and is the same with two threads") {
  const Grid grid{{40, 30, 20}};
  const LabelVolume before = random_labels(grid, 3, 5);
  LabelVolume other = before;
  for (Label& label : other.voxels) label = label == 1 ? 2 : label;
  CHECK(keeps_tissue_voxels(label_difference(before, other)));
  LabelVolume less = before;
  for (Label& label : less.voxels) label = label == 1 ? 0 : label;
  CHECK_FALSE(keeps_tissue_voxels(label_difference(before, less)));
  LabelChange one, two;
  {
    const ThreadCount threads(1);
    one = label_difference(before, less);
  }
  {
    const ThreadCount threads(2);
    two = label_difference(before, less);
  }
  CHECK(one == two);
  CHECK(one.heap_bytes() <
        one.voxel_count() * 4 + static_cast<std::int64_t>(one.runs.size() * sizeof(LabelChange::Run)) + 1);
}
