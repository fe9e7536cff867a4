// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/label_edit/islands.h"

#include <algorithm>
#include <numeric>

#include "core/volume/connected_components.h"

namespace limber {

RemovedIslands remove_islands(const LabelVolume& volume, Label label, const KeptIslands& kept) {
  LabelSet only(65536, 0);
  only[label] = 1;
  const Components pieces = connected_components(volume, nullptr, &only);
  std::vector<std::size_t> order(pieces.voxels.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return pieces.voxels[a] > pieces.voxels[b]; });
  std::vector<std::uint8_t> stays(order.size(), 0);
  RemovedIslands result;
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    const bool large = kept.largest <= 0 || rank < static_cast<std::size_t>(kept.largest),
               enough =
                   static_cast<double>(pieces.voxels[order[rank]]) * volume.grid.voxel_volume() >= kept.least_volume;
    stays[order[rank]] = large && enough;
    ++(large && enough ? result.kept : result.removed);
  }
  if (result.removed == 0) return result;
  std::vector<std::int64_t> voxels;
  for (std::size_t row = 0; row + 1 < pieces.first_run.size(); ++row)
    for (std::int64_t i = pieces.first_run[row]; i < pieces.first_run[row + 1]; ++i) {
      const Components::Run& run = pieces.runs[static_cast<std::size_t>(i)];
      if (stays[static_cast<std::size_t>(run.component)]) continue;
      for (std::int32_t x = run.begin; x < run.end; ++x)
        voxels.push_back(static_cast<std::int64_t>(row) * volume.grid.size.x + x);
    }
  result.change = erased_voxels(volume, voxels, label, kept.erased);
  return result;
}

}  // namespace limber
