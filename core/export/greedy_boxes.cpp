// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/export/greedy_boxes.h"

namespace limber {

std::vector<LabelBox> greedy_boxes(const LabelVolume& volume) {
  const Grid& grid = volume.grid;
  std::vector<bool> taken(volume.voxels.size());
  const auto is_free = [&](std::int64_t at, Label label) { return volume.voxels[at] == label && !taken[at]; };
  const auto run_is_free = [&](const LabelBox& box, int y, int z) {
    const std::int64_t row = grid.index({0, y, z});
    for (int x = box.low.x; x < box.high.x; ++x)
      if (!is_free(row + x, box.label)) return false;
    return true;
  };
  const auto layer_is_free = [&](const LabelBox& box, int z) {
    for (int y = box.low.y; y < box.high.y; ++y)
      if (!run_is_free(box, y, z)) return false;
    return true;
  };

  std::vector<LabelBox> boxes;
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y) {
      const std::int64_t row = grid.index({0, y, z});
      for (int x = 0; x < grid.size.x; ++x) {
        const Label label = volume.voxels[row + x];
        if (label == 0 || taken[row + x]) continue;
        LabelBox box{{x, y, z}, {x + 1, y + 1, z + 1}, label};
        while (box.high.x < grid.size.x && is_free(row + box.high.x, label)) ++box.high.x;
        while (box.high.y < grid.size.y && run_is_free(box, box.high.y, z)) ++box.high.y;
        while (box.high.z < grid.size.z && layer_is_free(box, box.high.z)) ++box.high.z;
        for (int k = z; k < box.high.z; ++k)
          for (int j = y; j < box.high.y; ++j)
            for (int i = x; i < box.high.x; ++i) taken[grid.index({i, j, k})] = true;
        boxes.push_back(box);
      }
    }
  return boxes;
}

}  // namespace limber
