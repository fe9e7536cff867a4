// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/label_edit/label_change.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "core/base/parallel.h"

namespace limber {

std::int64_t LabelChange::heap_bytes() const {
  return static_cast<std::int64_t>(runs.capacity() * sizeof(Run) +
                                   (before.capacity() + after.capacity()) * sizeof(Label));
}

void LabelChange::add(std::int64_t voxel, Label label_before, Label label_after) {
  if (label_before == label_after) return;
  if (!runs.empty() && runs.back().first + runs.back().count == voxel) ++runs.back().count;
  else runs.push_back({voxel, 1});
  before.push_back(label_before);
  after.push_back(label_after);
}

void LabelChange::append(const LabelChange& later) {
  auto first = later.runs.begin();
  if (!runs.empty() && first != later.runs.end() && runs.back().first + runs.back().count == first->first)
    runs.back().count += first++->count;
  runs.insert(runs.end(), first, later.runs.end());
  before.insert(before.end(), later.before.begin(), later.before.end());
  after.insert(after.end(), later.after.begin(), later.after.end());
}

LabelChange change_by_rows(const VoxelBox& box, const std::function<void(int y, int z, LabelChange& change)>& row) {
  std::vector<LabelChange> layers(static_cast<std::size_t>(std::max(box.size.z, 0)));
  parallel_for(std::ssize(layers), 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t layer = begin; layer < end; ++layer)
      for (int y = 0; y < box.size.y; ++y)
        row(box.lowest.y + y, box.lowest.z + static_cast<int>(layer), layers[static_cast<std::size_t>(layer)]);
  });
  LabelChange all;
  for (const LabelChange& layer : layers) all.append(layer);
  all.runs.shrink_to_fit();
  all.before.shrink_to_fit();
  all.after.shrink_to_fit();
  return all;
}

LabelChange label_difference(const LabelVolume& before, const LabelVolume& after) {
  return label_difference(before, after, {glm::ivec3(0), before.grid.size});
}

LabelChange label_difference(const LabelVolume& before, const LabelVolume& after, const VoxelBox& box) {
  assert(before.grid == after.grid);
  return change_by_rows(box, [&](int y, int z, LabelChange& change) {
    const std::int64_t first = before.grid.index({box.lowest.x, y, z});
    const Label *was = before.voxels.data() + first, *is = after.voxels.data() + first;
    if (std::memcmp(was, is, static_cast<std::size_t>(box.size.x) * sizeof(Label)) == 0) return;
    for (int x = 0; x < box.size.x; ++x) change.add(first + x, was[x], is[x]);
  });
}

namespace {

void write_labels(const LabelChange& change, const std::vector<Label>& labels, LabelVolume& volume) {
  const Label* from = labels.data();
  for (const LabelChange::Run& run : change.runs) {
    std::copy(from, from + run.count, volume.voxels.data() + run.first);
    from += run.count;
  }
}

}  // namespace

void apply_change(const LabelChange& change, LabelVolume& volume) { write_labels(change, change.after, volume); }
void take_back_change(const LabelChange& change, LabelVolume& volume) { write_labels(change, change.before, volume); }

VoxelBox bounds_of(const LabelChange& change, const Grid& grid) {
  glm::ivec3 low(grid.size), high(-1);
  for (const LabelChange::Run& run : change.runs) {
    const std::int64_t row = run.first / grid.size.x, last = (run.first + run.count - 1) / grid.size.x;
    // True: the run lies in one row. False: it also covers the end of its first row and the start of its last row.
    const bool one_row = row == last;
    const int x = static_cast<int>(run.first % grid.size.x);
    const glm::ivec3 from(one_row ? x : 0, row % grid.size.y, row / grid.size.y),
        to(one_row ? x + static_cast<int>(run.count) - 1 : grid.size.x - 1, last % grid.size.y, last / grid.size.y);
    low = glm::min(low, glm::min(from, to));
    high = glm::max(high, glm::max(from, to));
    if (row / grid.size.y != last / grid.size.y) low.y = 0, high.y = grid.size.y - 1;
  }
  return high.x < 0 ? VoxelBox{} : VoxelBox{low, high - low + 1};
}

bool keeps_tissue_voxels(const LabelChange& change) {
  for (std::size_t i = 0; i < change.after.size(); ++i)
    if ((change.before[i] == 0) != (change.after[i] == 0)) return false;
  return true;
}

VoxelBox label_box(const LabelVolume& volume, Label label, const glm::ivec3& margin) {
  const glm::ivec3 size = volume.grid.size;
  std::vector<glm::ivec3> lows(static_cast<std::size_t>(size.z), size), highs(lows.size(), glm::ivec3(-1));
  parallel_for(size.z, 4, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t z = begin; z < end; ++z)
      for (int y = 0; y < size.y; ++y) {
        const Label *row = &volume.voxels[volume.grid.index({0, y, z})], *row_end = row + size.x;
        const Label* first = std::find(row, row_end, label);
        if (first == row_end) continue;
        const Label* last = row_end - 1;
        while (*last != label) --last;
        glm::ivec3 &low = lows[static_cast<std::size_t>(z)], &high = highs[static_cast<std::size_t>(z)];
        low = glm::min(low, glm::ivec3(first - row, y, z));
        high = glm::max(high, glm::ivec3(last - row, y, z));
      }
  });
  glm::ivec3 low = size, high(-1);
  for (std::size_t z = 0; z < lows.size(); ++z) low = glm::min(low, lows[z]), high = glm::max(high, highs[z]);
  if (high.x < 0) return {};
  low = glm::max(low - margin, glm::ivec3(0));
  high = glm::min(high + margin, size - 1);
  return {low, high - low + 1};
}

}  // namespace limber
