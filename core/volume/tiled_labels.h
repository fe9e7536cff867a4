// SPDX-License-Identifier: AGPL-3.0-or-later
// Holds one label per voxel, as LabelVolume does, in tiles of 16 x 16 x 8 voxels. A tile fills one page of memory
// (4 KB), and a page takes memory only once it is written. So memory grows with the tissue. In a LabelVolume, a page
// holds a stretch of rows across the whole grid, most of which is air where a page holds any tissue at all: a body of
// 0.5 mm takes 2.4 GB in rows and 1 GB in tiles, its bones 1.4 GB and 0.15 GB.
#pragma once

#include <cstdint>
#include <span>

#include "core/volume/label_volume.h"

namespace limber {

class TiledLabels {
 public:
  static constexpr glm::ivec3 kTile{16, 16, 8};
  static constexpr std::int64_t kTileVoxels = std::int64_t{kTile.x} * kTile.y * kTile.z;

  TiledLabels() = default;
  explicit TiledLabels(const Grid& grid);  // all air

  const Grid& grid() const { return grid_; }
  Label at(const glm::ivec3& v) const { return data()[row(v.y, v.z) + along_row(v.x)]; }
  Label& at(const glm::ivec3& v) { return data()[row(v.y, v.z) + along_row(v.x)]; }

  // The label of voxel (x, y, z) lies at data()[row(y, z) + along_row(x)].
  const Label* data() const { return pages_.data() + first_; }
  Label* data() { return pages_.data() + first_; }
  std::int64_t row(int y, int z) const {
    return ((y >> 4) + std::int64_t{tiles_.y} * (z >> 3)) * tiles_.x * kTileVoxels + 16 * (y & 15) + 256 * (z & 7);
  }
  static std::int64_t along_row(int x) { return (x >> 4) * kTileVoxels + (x & 15); }

  // Copies row (y, z), whose length is the size of the grid along x.
  void copy_row(int y, int z, Label* to) const;

 private:
  friend LabelVolume in_rows(TiledLabels tiles);

  Grid grid_;
  glm::ivec3 tiles_{0};
  ZeroedVector<Label> pages_;
  std::int64_t first_ = 0;  // index in pages_ of the first label, which lies at the beginning of a memory page
};

// Returns the same labels in rows. The memory of the tiles is given back while the rows are written.
LabelVolume in_rows(TiledLabels tiles);

}  // namespace limber
