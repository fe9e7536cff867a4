// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/label_edit/fill_holes.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace limber {

namespace {

// A run of voxels along x that do not have the label, and the group of connected runs to which it belongs.
struct Run {
  std::int32_t begin, end;  // positions along x, relative to the box
  std::int64_t group;
  bool tissue;  // true: at least one of the voxels is tissue
};

// Union-find over runs: groups that touch are merged. A group is identified by its run with the smallest index.
class Groups {
 public:
  void add() { parent_.push_back(std::ssize(parent_)); }
  std::int64_t root(std::int64_t at) {
    while (parent_[static_cast<std::size_t>(at)] != at)
      at = parent_[static_cast<std::size_t>(at)] =
          parent_[static_cast<std::size_t>(parent_[static_cast<std::size_t>(at)])];
    return at;
  }
  void merge(std::int64_t a, std::int64_t b) {
    a = root(a), b = root(b);
    parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<std::int64_t> parent_;
};

struct Rows {
  std::vector<Run> runs;
  std::vector<std::size_t> first;  // #rows + 1: index of the first run of row y + size.y * z of the box
};

Rows rows_without(const LabelVolume& volume, Label label, const VoxelBox& box) {
  Rows rows;
  for (int z = 0; z < box.size.z; ++z)
    for (int y = 0; y < box.size.y; ++y) {
      rows.first.push_back(rows.runs.size());
      const Label* row = &volume.voxels[volume.grid.index(box.lowest + glm::ivec3(0, y, z))];
      for (int x = 0; x < box.size.x;) {
        if (row[x] == label) {
          ++x;
          continue;
        }
        Run run{x, x, std::ssize(rows.runs), false};
        for (; x < box.size.x && row[x] != label; ++x) run.tissue |= row[x] != 0;
        run.end = x;
        rows.runs.push_back(run);
      }
    }
  rows.first.push_back(rows.runs.size());
  return rows;
}

void join(Rows& rows, const VoxelBox& box) {
  Groups groups;
  for (std::size_t i = 0; i < rows.runs.size(); ++i) groups.add();
  const auto merge_rows = [&](std::size_t a, std::size_t b) {
    std::size_t i = rows.first[a], j = rows.first[b];
    while (i < rows.first[a + 1] && j < rows.first[b + 1]) {
      const Run &one = rows.runs[i], &other = rows.runs[j];
      if (one.begin < other.end && other.begin < one.end)
        groups.merge(static_cast<std::int64_t>(i), static_cast<std::int64_t>(j));
      ++(one.end < other.end ? i : j);
    }
  };
  for (int z = 0; z < box.size.z; ++z)
    for (int y = 0; y < box.size.y; ++y) {
      const std::size_t row = static_cast<std::size_t>(y) + static_cast<std::size_t>(box.size.y) * z;
      if (y > 0) merge_rows(row, row - 1);
      if (z > 0) merge_rows(row, row - static_cast<std::size_t>(box.size.y));
    }
  for (Run& run : rows.runs) run.group = groups.root(run.group);
}

struct Hole {
  std::int64_t voxels = 0;
  bool open = false, tissue = false;
};

std::vector<Hole> holes_of(const Rows& rows, const VoxelBox& box) {
  std::vector<Hole> holes(rows.runs.size());
  for (std::size_t row = 0; row + 1 < rows.first.size(); ++row) {
    const int y = static_cast<int>(row % static_cast<std::size_t>(box.size.y)),
              z = static_cast<int>(row / static_cast<std::size_t>(box.size.y));
    const bool rim = y == 0 || z == 0 || y == box.size.y - 1 || z == box.size.z - 1;
    for (std::size_t i = rows.first[row]; i < rows.first[row + 1]; ++i) {
      const Run& run = rows.runs[i];
      Hole& hole = holes[static_cast<std::size_t>(run.group)];
      hole.voxels += run.end - run.begin;
      hole.tissue |= run.tissue;
      hole.open |= rim || run.begin == 0 || run.end == box.size.x;
    }
  }
  return holes;
}

}  // namespace

FilledHoles fill_holes(const LabelVolume& volume, Label label, const HolesToFill& wanted) {
  FilledHoles result;
  const VoxelBox box = label_box(volume, label);
  if (box.size.x == 0) return result;
  Rows rows = rows_without(volume, label, box);
  join(rows, box);
  const std::vector<Hole> holes = holes_of(rows, box);
  std::vector<std::uint8_t> fills(holes.size(), 0);
  for (std::size_t i = 0; i < holes.size(); ++i) {
    if (holes[i].voxels == 0 || holes[i].open) continue;
    const double mm3 = static_cast<double>(holes[i].voxels) * volume.grid.voxel_volume();
    fills[i] = !(wanted.only_air && holes[i].tissue) && (wanted.largest_volume <= 0 || mm3 <= wanted.largest_volume);
    ++(fills[i] ? result.filled : result.left);
  }
  for (std::size_t row = 0; row + 1 < rows.first.size(); ++row) {
    const int y = static_cast<int>(row % static_cast<std::size_t>(box.size.y)),
              z = static_cast<int>(row / static_cast<std::size_t>(box.size.y));
    const std::int64_t first = volume.grid.index(box.lowest + glm::ivec3(0, y, z));
    for (std::size_t i = rows.first[row]; i < rows.first[row + 1]; ++i)
      if (fills[static_cast<std::size_t>(rows.runs[i].group)])
        for (int x = rows.runs[i].begin; x < rows.runs[i].end; ++x)
          result.change.add(first + x, volume.voxels[static_cast<std::size_t>(first + x)], label);
  }
  return result;
}

}  // namespace limber
