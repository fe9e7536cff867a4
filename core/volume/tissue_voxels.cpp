// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/tissue_voxels.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "core/base/error.h"
#include "core/volume/label_runs.h"

namespace limber {

namespace {

// Positions are kept as 16-bit numbers, places in the list as 32-bit ones.
constexpr int kLongest = std::numeric_limits<std::int16_t>::max();
constexpr std::int64_t kMostPlaces = std::numeric_limits<std::int32_t>::max();

// Bit x for label x of `count`, at most eight.
std::uint64_t tissue_bits(const Label* row, int count) {
  constexpr std::uint64_t kBelowHighest = 0x7fff7fff7fff7fff;
  std::uint64_t fours[2] = {0, 0};
  std::memcpy(fours, row, count * sizeof(Label));
  std::uint64_t bits = 0;
  for (int i = 0; i < 2; ++i) {
    // The highest bit of each label is set where the label is not 0.
    const std::uint64_t highest = ((fours[i] & kBelowHighest) + kBelowHighest) | fours[i];
    bits |= ((highest >> 15 & 0x0001000100010001) * 0x0001000200040008 >> 48 & 0xf) << (4 * i);
  }
  return bits;
}

}  // namespace

TissueVoxels::TissueVoxels(const LabelVolume& volume) : grid_size_(volume.grid.size) {
  const int longest = std::max({grid_size_.x, grid_size_.y, grid_size_.z});
  if (longest > kLongest)
    throw Error("the volume is " + std::to_string(longest) + " voxels long", "along one axis",
                "crop it to " + std::to_string(kLongest) + ", or choose a coarser spacing");
  brick_grid_ = (grid_size_ + (kBrick - 1)) / kBrick;
  brick_of_.assign(std::int64_t{brick_grid_.x} * brick_grid_.y * brick_grid_.z, -1);
  std::vector<std::array<std::uint64_t, kBrick>> masks(brick_grid_.x);  // of a row of bricks
  std::int64_t cell = 0;
  for (int bz = 0; bz < brick_grid_.z; ++bz)
    for (int by = 0; by < brick_grid_.y; ++by) {
      std::fill(masks.begin(), masks.end(), std::array<std::uint64_t, kBrick>{});
      const int end_z = std::min((bz + 1) * kBrick, grid_size_.z), end_y = std::min((by + 1) * kBrick, grid_size_.y);
      for (int z = bz * kBrick; z < end_z; ++z)
        for (int y = by * kBrick; y < end_y; ++y) {
          const Label* row = &volume.voxels[volume.grid.index({0, y, z})];
          // Air, by far the most, is passed quickly.
          for (int x = end_of_air(row, 0, grid_size_.x); x < grid_size_.x; x = end_of_air(row, x, grid_size_.x)) {
            const int first = x & ~7;
            x = std::min(first + kBrick, grid_size_.x);
            masks[first / kBrick][z & 7] |= tissue_bits(row + first, x - first) << (8 * (y & 7));
          }
        }
      for (int bx = 0; bx < brick_grid_.x; ++bx, ++cell) {
        if (masks[bx] == std::array<std::uint64_t, kBrick>{}) continue;
        Brick brick{glm::ivec3(bx, by, bz) * kBrick, size_, masks[bx]};
        for (int z = 1; z < kBrick; ++z) brick.below[z] = static_cast<std::uint16_t>(brick.below[z - 1] + std::popcount(brick.mask[z - 1]));
        const int count = brick.below[kBrick - 1] + std::popcount(brick.mask[kBrick - 1]);
        brick_of_[cell] = static_cast<std::int32_t>(bricks_.size());
        bricks_.push_back(brick);
        size_ += count;
      }
    }
  if (size_ > kMostPlaces)
    throw Error("the volume has " + std::to_string(size_) + " tissue voxels", "of " + std::to_string(kMostPlaces) + " at most",
                "crop it, or choose a coarser spacing");
}

RowSet TissueVoxels::rows() const {
  RowSet rows(std::int64_t{grid_size_.y} * grid_size_.z, 0);
  for (const Brick& brick : bricks_)
    for (int z = 0; z < kBrick; ++z)
      for (int y = 0; y < kBrick; ++y)
        if (brick.mask[z] >> (8 * y) & 0xff) rows[brick.corner.y + y + std::int64_t{grid_size_.y} * (brick.corner.z + z)] = 1;
  return rows;
}

}  // namespace limber
