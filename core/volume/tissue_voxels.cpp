// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/tissue_voxels.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "core/base/error.h"

namespace limber {

namespace {

// Positions are kept as 16-bit numbers, places in the list as 32-bit ones.
constexpr int kLongest = std::numeric_limits<std::int16_t>::max();
constexpr std::int64_t kMostPlaces = std::numeric_limits<std::int32_t>::max();

// Bit x for label x of eight. Air, by far the most, is seen at a glance.
std::uint64_t tissue_bits(const Label* row) {
  std::uint64_t half[2];
  std::memcpy(half, row, sizeof half);
  if (!(half[0] | half[1])) return 0;
  std::uint64_t bits = 0;
  for (int x = 0; x < TissueVoxels::kBrick; ++x) bits |= std::uint64_t{row[x] != 0} << x;
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
  std::int64_t cell = 0;
  for (int bz = 0; bz < brick_grid_.z; ++bz)
    for (int by = 0; by < brick_grid_.y; ++by)
      for (int bx = 0; bx < brick_grid_.x; ++bx, ++cell) {
        Brick brick{glm::ivec3(bx, by, bz) * kBrick, size_, {}};
        const glm::ivec3 end = glm::min(brick.corner + kBrick, grid_size_);
        for (int z = brick.corner.z; z < end.z; ++z)
          for (int y = brick.corner.y; y < end.y; ++y) {
            const Label* row = &volume.voxels[volume.grid.index({brick.corner.x, y, z})];
            std::uint64_t bits = 0;
            if (end.x - brick.corner.x == kBrick)
              bits = tissue_bits(row);
            else
              for (int x = 0; x < end.x - brick.corner.x; ++x) bits |= std::uint64_t{row[x] != 0} << x;
            brick.mask[z & 7] |= bits << (8 * (y & 7));
          }
        for (int z = 1; z < kBrick; ++z) brick.below[z] = static_cast<std::uint16_t>(brick.below[z - 1] + std::popcount(brick.mask[z - 1]));
        const int count = brick.below[kBrick - 1] + std::popcount(brick.mask[kBrick - 1]);
        if (count == 0) continue;
        brick_of_[cell] = static_cast<std::int32_t>(bricks_.size());
        bricks_.push_back(brick);
        size_ += count;
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
