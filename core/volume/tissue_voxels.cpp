// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/tissue_voxels.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/volume/label_runs.h"

namespace limber {

namespace {

// Upper limits on the voxels of the grid along one axis and on the tissue voxels in the list, because voxel positions
// are stored as 16-bit numbers and list indices as 32-bit numbers.
constexpr int kLongest = std::numeric_limits<std::int16_t>::max();
constexpr std::int64_t kMostPlaces = std::numeric_limits<std::int32_t>::max();

// Returns a mask in which bit x is set when label x is not air, for the first `count` labels of a row (at most eight).
std::uint64_t tissue_bits(const Label* row, int count) {
  constexpr std::uint64_t kBelowHighest = 0x7fff7fff7fff7fff;
  std::uint64_t fours[2] = {0, 0};
  std::memcpy(fours, row, count * sizeof(Label));
  std::uint64_t bits = 0;
  for (int i = 0; i < 2; ++i) {
    // In `highest`, the highest bit of each 16-bit label is set when the label is not 0.
    const std::uint64_t highest = ((fours[i] & kBelowHighest) + kBelowHighest) | fours[i];
    bits |= ((highest >> 15 & 0x0001000100010001) * 0x0001000200040008 >> 48 & 0xf) << (4 * i);
  }
  return bits;
}

// Returns the bricks with tissue in one layer of bricks, whose index along z is `bz`. They are in brick order.
std::vector<TissueVoxels::Brick> bricks_of_layer(const LabelVolume& volume, int bz) {
  constexpr int kBrick = TissueVoxels::kBrick;
  const glm::ivec3 size = volume.grid.size;
  std::vector<TissueVoxels::Brick> bricks;
  // Bit masks of the tissue voxels of one row of bricks along x: for each brick, a word for each slice (Brick::mask).
  std::vector<std::array<std::uint64_t, kBrick>> masks((size.x + (kBrick - 1)) / kBrick);
  for (int by = 0; by * kBrick < size.y; ++by) {
    std::fill(masks.begin(), masks.end(), std::array<std::uint64_t, kBrick>{});
    const int end_z = std::min((bz + 1) * kBrick, size.z), end_y = std::min((by + 1) * kBrick, size.y);
    for (int z = bz * kBrick; z < end_z; ++z)
      for (int y = by * kBrick; y < end_y; ++y) {
        const Label* row = &volume.voxels[volume.grid.index({0, y, z})];
        // end_of_air() skips air, by far the most common label, several voxels at a time.
        for (int x = end_of_air(row, 0, size.x); x < size.x; x = end_of_air(row, x, size.x)) {
          const int first = x & ~7;
          x = std::min(first + kBrick, size.x);
          masks[first / kBrick][z & 7] |= tissue_bits(row + first, x - first) << (8 * (y & 7));
        }
      }
    for (int bx = 0; bx < std::ssize(masks); ++bx) {
      if (masks[bx] == std::array<std::uint64_t, kBrick>{}) continue;
      TissueVoxels::Brick brick{glm::ivec3(bx, by, bz) * kBrick, 0, masks[bx]};
      for (int z = 1; z < kBrick; ++z)
        brick.below[z] = static_cast<std::uint16_t>(brick.below[z - 1] + std::popcount(brick.mask[z - 1]));
      bricks.push_back(brick);
    }
  }
  return bricks;
}

}  // namespace

TissueVoxels::TissueVoxels(const LabelVolume& volume) : grid_size_(volume.grid.size) {
  const int longest = std::max({grid_size_.x, grid_size_.y, grid_size_.z});
  if (longest > kLongest)
    throw Error("the volume is " + std::to_string(longest) + " voxels long", "along one axis",
                "crop it to " + std::to_string(kLongest) + ", or choose a coarser spacing");
  brick_grid_ = (grid_size_ + (kBrick - 1)) / kBrick;
  brick_of_.assign(std::int64_t{brick_grid_.x} * brick_grid_.y * brick_grid_.z, -1);
  // Collects the bricks of each layer in parallel. Brick::first is set afterwards, because the list index of a brick's
  // first voxel depends on the number of voxels in all bricks before it.
  std::vector<std::vector<Brick>> layers(brick_grid_.z);
  parallel_for(brick_grid_.z, 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t bz = begin; bz < end; ++bz) layers[bz] = bricks_of_layer(volume, static_cast<int>(bz));
  });
  for (std::vector<Brick>& layer : layers)
    for (Brick& brick : layer) {
      const glm::ivec3 cell = brick.corner / kBrick;
      brick.first = size_;
      size_ += brick.below[kBrick - 1] + std::popcount(brick.mask[kBrick - 1]);
      brick_of_[cell.x + std::int64_t{brick_grid_.x} * (cell.y + std::int64_t{brick_grid_.y} * cell.z)] =
          static_cast<std::int32_t>(bricks_.size());
      bricks_.push_back(brick);
    }
  if (size_ > kMostPlaces)
    throw Error("the volume has " + std::to_string(size_) + " tissue voxels",
                "of " + std::to_string(kMostPlaces) + " at most", "crop it, or choose a coarser spacing");
}

RowSet TissueVoxels::rows() const {
  RowSet rows(std::int64_t{grid_size_.y} * grid_size_.z, 0);
  for (const Brick& brick : bricks_)
    for (int z = 0; z < kBrick; ++z)
      for (int y = 0; y < kBrick; ++y)
        if (brick.mask[z] >> (8 * y) & 0xff)
          rows[brick.corner.y + y + std::int64_t{grid_size_.y} * (brick.corner.z + z)] = 1;
  return rows;
}

}  // namespace limber
