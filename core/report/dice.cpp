// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/dice.h"

#include <cassert>

namespace limber {

std::vector<double> dice_by_label(const LabelVolume& a, const LabelVolume& b) {
  assert(a.voxels.size() == b.voxels.size());
  std::vector<std::int64_t> both(65536), sum(65536);
  for (std::size_t i = 0; i < a.voxels.size(); ++i) {
    ++sum[a.voxels[i]];
    ++sum[b.voxels[i]];
    both[a.voxels[i]] += a.voxels[i] == b.voxels[i];
  }
  std::vector<double> dice(65536);
  for (std::size_t label = 0; label < dice.size(); ++label)
    if (sum[label]) dice[label] = 2 * double(both[label]) / double(sum[label]);
  return dice;
}

}  // namespace limber
