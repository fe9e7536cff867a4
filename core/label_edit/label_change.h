// SPDX-License-Identifier: AGPL-3.0-or-later
// The difference that an edit of labels makes: the changed voxels, with their labels before and after. Its memory grows
// with the number of changed voxels, not with the volume, so an undo history can store many of them. Applying a change
// and reverting it restores the volume bit for bit.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/volume/distance_transform.h"
#include "core/volume/label_volume.h"

namespace limber {

struct LabelChange {
  // Changed voxels with successive indices in the volume: first .. first + count - 1.
  struct Run {
    std::int64_t first;
    std::int64_t count;
    bool operator==(const Run&) const = default;
  };
  std::vector<Run> runs;             // in ascending order, never adjacent
  std::vector<Label> before, after;  // one label for each changed voxel, run by run

  bool operator==(const LabelChange&) const = default;
  bool empty() const { return runs.empty(); }
  std::int64_t voxel_count() const { return std::ssize(after); }
  std::int64_t heap_bytes() const;

  // Adds a changed voxel. Voxels must be added in ascending order; a voxel whose label stays the same is left out.
  void add(std::int64_t voxel, Label label_before, Label label_after);
  // Appends the changed voxels of another change, which must all come after those of this change.
  void append(const LabelChange& later);
};

// Returns the voxels in which `after` differs from `before`. Both must have the same grid.
LabelChange label_difference(const LabelVolume& before, const LabelVolume& after);
// Returns the voxels of a box, which must lie inside the grid, in which `after` differs from `before`.
LabelChange label_difference(const LabelVolume& before, const LabelVolume& after, const VoxelBox& box);

void apply_change(const LabelChange& change, LabelVolume& volume);
void take_back_change(const LabelChange& change, LabelVolume& volume);

// Returns the smallest box that holds all changed voxels; size 0 if nothing changed.
VoxelBox bounds_of(const LabelChange& change, const Grid& grid);
// Returns whether the same voxels are tissue before and after the change.
bool keeps_tissue_voxels(const LabelChange& change);

// Returns the smallest box that holds all voxels of a label, extended by `margin` voxels on each side as far as the
// grid reaches; size 0 if the volume has no such voxel.
VoxelBox label_box(const LabelVolume& volume, Label label, const glm::ivec3& margin = glm::ivec3(0));

// Collects a change from all rows of a box, in the order of the volume.
//   row  called once for each row along x, from several threads; adds the row's changed voxels to `change`
LabelChange change_by_rows(const VoxelBox& box, const std::function<void(int y, int z, LabelChange& change)>& row);

}  // namespace limber
