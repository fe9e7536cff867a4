// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and writes the labels of a volume that is stored in rows (LabelVolume) or in tiles (TiledLabels). Functions
// that repair a posed body use these views, so that they work on both.
#pragma once

#include <cstdint>
#include <vector>

#include "core/volume/label_volume.h"
#include "core/volume/tiled_labels.h"

namespace limber {

// A read-only view of labels. The volume must outlive it.
class LabelView {
 public:
  LabelView(const LabelVolume& volume) : grid(volume.grid), first_(volume.voxels.data()) {}
  LabelView(const TiledLabels& tiles) : grid(tiles.grid()), first_(tiles.data()), tiles_(&tiles) {}

  const Grid& grid;

  Label at(const glm::ivec3& v) const { return first_[place(v)]; }
  // Returns the label of a voxel, and air outside the grid.
  Label at_or_air(const glm::ivec3& v) const { return grid.contains(v) ? at(v) : Label{0}; }

  // Returns the labels of row (y, z). Copies them into `room` if they are not contiguous in memory.
  const Label* row(int y, int z, std::vector<Label>& room) const {
    if (!tiles_) return first_ + grid.index({0, y, z});
    room.resize(grid.size.x);
    tiles_->copy_row(y, z, room.data());
    return room.data();
  }

  // A voxel whose 26 neighbours are at fixed offsets from it in memory; `at` is null for any other voxel.
  struct Centre {
    const Label* at;
    std::int64_t row, slice;  // offset in memory to the next voxel along y, along z
  };
  Centre centre(const glm::ivec3& v) const {
    const glm::ivec3 in = tiles_ ? v & (TiledLabels::kTile - 1) : v, size = tiles_ ? TiledLabels::kTile : grid.size;
    const bool inside = in.x > 0 && in.y > 0 && in.z > 0 && in.x + 1 < size.x && in.y + 1 < size.y && in.z + 1 < size.z;
    return {inside ? first_ + place(v) : nullptr, size.x, std::int64_t{size.x} * size.y};
  }

  // Returns true if this view and `other` are views of the same labels.
  bool is_of_same(const LabelView& other) const { return first_ == other.first_; }

 protected:
  std::int64_t place(const glm::ivec3& v) const {
    return tiles_ ? tiles_->row(v.y, v.z) + TiledLabels::along_row(v.x) : grid.index(v);
  }

 private:
  const Label* first_;
  const TiledLabels* tiles_ = nullptr;  // null: the labels lie in rows
};

// A view of labels to read and to write. The volume must outlive it.
class LabelEdit : public LabelView {
 public:
  LabelEdit(LabelVolume& volume) : LabelView(volume), first_(volume.voxels.data()) {}
  LabelEdit(TiledLabels& tiles) : LabelView(tiles), first_(tiles.data()) {}

  Label& at(const glm::ivec3& v) const { return first_[place(v)]; }

 private:
  Label* first_;
};

}  // namespace limber
