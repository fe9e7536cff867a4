// SPDX-License-Identifier: AGPL-3.0-or-later
// Holds one value per voxel in tiles of 16 x 16 x 8 voxels. A memory page (4 KB) belongs to one tile, and takes memory
// only once it is written. So memory grows with the amount of tissue. If values are stored in rows, a page extends
// across the whole grid and contains mostly air even where it contains tissue. The labels of a body of 0.5 mm take 2.4
// GB in rows (LabelVolume) and 1 GB in tiles, those of its bones alone 1.4 GB and 0.15 GB.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "core/volume/label_volume.h"

namespace limber {

template <class Value>
class TiledValues {
 public:
  static constexpr glm::ivec3 kTile{16, 16, 8};
  static constexpr std::int64_t kTileVoxels = std::int64_t{kTile.x} * kTile.y * kTile.z;

  TiledValues() = default;
  explicit TiledValues(const Grid& grid) : grid_(grid), tiles_((grid.size + kTile - 1) / kTile) {
    pages_.resize(std::int64_t{tiles_.x} * tiles_.y * tiles_.z * kTileVoxels + kTileVoxels);
    constexpr std::uintptr_t kPage = 4096;
    const std::uintptr_t begin = reinterpret_cast<std::uintptr_t>(pages_.data());
    // Bytes from the start of the memory to its first page, at which the values begin.
    const std::uintptr_t before = (kPage - begin % kPage) % kPage;
    if (before % sizeof(Value) == 0) first_ = static_cast<std::int64_t>(before / sizeof(Value));
  }

  bool empty() const { return pages_.empty(); }
  const Grid& grid() const { return grid_; }
  const Value& at(const glm::ivec3& v) const { return data()[row(v.y, v.z) + along_row(v.x)]; }
  Value& at(const glm::ivec3& v) { return data()[row(v.y, v.z) + along_row(v.x)]; }

  // The value of voxel (x, y, z) lies at data()[row(y, z) + along_row(x)].
  const Value* data() const { return pages_.data() + first_; }
  Value* data() { return pages_.data() + first_; }
  std::int64_t row(int y, int z) const {
    return ((y >> 4) + std::int64_t{tiles_.y} * (z >> 3)) * tiles_.x * kTileVoxels + 16 * (y & 15) + 256 * (z & 7);
  }
  static std::int64_t along_row(int x) { return (x >> 4) * kTileVoxels + (x & 15); }

  // Copies row (y, z), whose length is the size of the grid along x.
  void copy_row(int y, int z, Value* to) const {
    constexpr std::int64_t kLine = kTile.x;
    const Value* from = data() + row(y, z);
    int x = 0;
    for (; x + kLine <= grid_.size.x; x += kLine, from += kTileVoxels) std::memcpy(to + x, from, kLine * sizeof(Value));
    std::copy_n(from, grid_.size.x - x, to + x);
  }

 private:
  friend LabelVolume in_rows(TiledValues<Label> tiles);

  Grid grid_;
  glm::ivec3 tiles_{0};
  ZeroedVector<Value> pages_;
  std::int64_t first_ = 0;  // index in pages_ of the first value, which lies at the beginning of a memory page
};

using TiledLabels = TiledValues<Label>;
using TiledVectors = TiledValues<glm::vec3>;

// Returns the same labels in rows. Releases the memory of the tiles while the rows are written.
LabelVolume in_rows(TiledLabels tiles);

}  // namespace limber
