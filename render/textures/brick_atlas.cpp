// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/textures/brick_atlas.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/parallel.h"

namespace limber::render {

namespace {

// Marks every block within kBrick voxels of a tissue voxel: all blocks that touch the voxel's brick (kBrick^3 voxels),
// or one of the 26 bricks around that brick.
void mark_blocks(const LabelVolume& volume, const BlockLayout& layout, std::vector<std::uint8_t>& marked) {
  const glm::ivec3 size = volume.grid.size;
  // Number of bricks along each axis, without the padding (one brick on each side).
  const glm::ivec3 tissue_bricks = (size + kBrick - 1) / kBrick;
  std::vector<std::uint8_t> tissue(static_cast<size_t>(tissue_bricks.x) * tissue_bricks.y * tissue_bricks.z);
  parallel_for(tissue_bricks.z, 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t bz = begin; bz < end; ++bz)
      for (int z = int(bz) * kBrick; z < std::min(size.z, int(bz + 1) * kBrick); ++z)
        for (int y = 0; y < size.y; ++y) {
          const Label* row = volume.voxels.data() + volume.grid.index({0, y, z});
          std::uint8_t* out = tissue.data() + (bz * tissue_bricks.y + y / kBrick) * tissue_bricks.x;
          int x = 0;
          for (; x + kBrick <= size.x; x += kBrick)
            out[x / kBrick] |= (row[x] | row[x + 1] | row[x + 2] | row[x + 3]) != 0;
          for (; x < size.x; ++x) out[x / kBrick] |= row[x] != 0;
        }
  });

  size_t i = 0;
  for (int z = 0; z < tissue_bricks.z; ++z)
    for (int y = 0; y < tissue_bricks.y; ++y)
      for (int x = 0; x < tissue_bricks.x; ++x, ++i) {
        if (!tissue[i]) continue;
        // Brick b of the unpadded grid is brick b + 1 of the padded grid. The brick and its neighbours are therefore
        // the bricks from b to b + 2 of the padded grid.
        const glm::ivec3 low = glm::ivec3(x, y, z) / kBricksPerBlock;
        const glm::ivec3 high = glm::min((glm::ivec3(x, y, z) + 2) / kBricksPerBlock, layout.blocks - 1);
        for (int c = low.z; c <= high.z; ++c)
          for (int b = low.y; b <= high.y; ++b)
            for (int a = low.x; a <= high.x; ++a) marked[static_cast<size_t>(layout.block_index({a, b, c}))] = 1;
      }
}

Label most_frequent(const std::array<Label, 8>& labels) {
  Label best = 0;
  int most = 0;
  for (const Label label : labels) {
    if (label == 0) continue;
    const int count = static_cast<int>(std::count(labels.begin(), labels.end(), label));
    if (count > most || (count == most && label < best)) best = label, most = count;
  }
  return most > 0 && std::count(labels.begin(), labels.end(), Label{0}) <= 4 ? best : Label{0};
}

}  // namespace

glm::ivec3 BlockLayout::place_of(int slot) const {
  const int local = slot % slots_per_atlas();
  return {local % slots.x, local / slots.x % slots.y, local / (slots.x * slots.y)};
}

BlockLayout block_layout(const LabelVolume& volume) {
  BlockLayout layout;
  layout.blocks = (volume.grid.size + 2 * kPad + kBlock - 1) / kBlock;
  const auto count = static_cast<size_t>(layout.blocks.x) * layout.blocks.y * layout.blocks.z;
  std::vector<std::uint8_t> marked(count);
  mark_blocks(volume, layout, marked);
  layout.slot_of_block.assign(count, -1);
  for (size_t b = 0; b < count; ++b) {
    if (!marked[b]) continue;
    layout.slot_of_block[b] = static_cast<int>(layout.block_of_slot.size());
    const int i = static_cast<int>(b);
    layout.block_of_slot.push_back(
        {i % layout.blocks.x, i / layout.blocks.x % layout.blocks.y, i / (layout.blocks.x * layout.blocks.y)});
  }
  return layout;
}

bool place_slots(BlockLayout& layout, int largest_texture) {
  // Largest number of slots per axis of an atlas. It is limited since the index texture stores slot positions as bytes.
  const int across = std::min(largest_texture / kSlot, 255);
  const int count = std::max(1, static_cast<int>(layout.block_of_slot.size()));
  if (across == 0 || glm::any(glm::greaterThan(layout.blocks, glm::ivec3(largest_texture)))) return false;
  const int side = std::clamp(static_cast<int>(std::ceil(std::cbrt(double(count)))), 1, across);
  const auto layers = (count + side * side - 1) / (side * side);
  layout.slots = {side, side, std::min(layers, across)};
  layout.atlases = (count + layout.slots_per_atlas() - 1) / layout.slots_per_atlas();
  return layout.atlases <= kMostAtlases;
}

Grid halved(const Grid& grid) {
  Grid half = grid;
  half.size = (grid.size + 1) / 2;
  half.spacing = grid.spacing * 2.0;
  half.origin = world_from_voxel(grid) * glm::dvec3(0.5);
  return half;
}

LabelVolume halved(const LabelVolume& volume) {
  LabelVolume half;
  half.grid = halved(volume.grid);
  half.voxels.resize(static_cast<size_t>(half.grid.voxel_count()));
  parallel_for(half.grid.size.z, 1, [&](std::int64_t begin, std::int64_t end) {
    for (int z = int(begin); z < end; ++z)
      for (int y = 0; y < half.grid.size.y; ++y)
        for (int x = 0; x < half.grid.size.x; ++x) {
          std::array<Label, 8> labels;
          for (int i = 0; i < 8; ++i)
            labels[i] = volume.at_or_air({2 * x + (i & 1), 2 * y + (i >> 1 & 1), 2 * z + (i >> 2)});
          half.at({x, y, z}) = most_frequent(labels);
        }
  });
  return half;
}

}  // namespace limber::render
