// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/tiled_labels.h"

#include <algorithm>
#include <cstring>

#include "core/base/parallel.h"
#include "core/platform/give_back_pages.h"
#include "core/volume/label_pages.h"

namespace limber {

namespace {

constexpr std::int64_t kLine = TiledLabels::kTile.x;  // number of labels of a row within a tile

bool is_air(const Label* line) {
  std::uint64_t words[kLine * sizeof(Label) / sizeof(std::uint64_t)];
  std::memcpy(words, line, sizeof words);
  return (words[0] | words[1] | words[2] | words[3]) == 0;
}

// Copies the lines of a tile that hold tissue to the volume `to`.
//   low  lowest voxel of the tile
void copy_tile(const Label* tile, const glm::ivec3& low, LabelVolume& to) {
  const glm::ivec3 count = glm::min(TiledLabels::kTile, to.grid.size - low);
  for (int z = 0; z < count.z; ++z)
    for (int y = 0; y < count.y; ++y)
      if (const Label* line = tile + kLine * (y + TiledLabels::kTile.y * z); !is_air(line))
        std::memcpy(&to.voxels[to.grid.index(low + glm::ivec3(0, y, z))], line, count.x * sizeof(Label));
}

}  // namespace

LabelVolume in_rows(TiledLabels tiles) {
  LabelVolume volume{tiles.grid_, ZeroedVector<Label>(static_cast<std::size_t>(tiles.grid_.voxel_count()))};
  want_large_pages(volume);
  const glm::ivec3 count = tiles.tiles_;
  const std::int64_t layer = std::int64_t{count.x} * count.y * TiledLabels::kTileVoxels;
  parallel_for(count.z, 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t z = begin; z < end; ++z) {
      Label* tile = tiles.data() + z * layer;
      for (int y = 0; y < count.y; ++y)
        for (int x = 0; x < count.x; ++x, tile += TiledLabels::kTileVoxels)
          copy_tile(tile, glm::ivec3(x, y, z) * TiledLabels::kTile, volume);
      give_back_pages(tiles.data() + z * layer, layer * std::int64_t{sizeof(Label)});
    }
  });
  return volume;
}

}  // namespace limber
