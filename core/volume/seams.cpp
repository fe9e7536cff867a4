// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/seams.h"

namespace limber {

Seams::Seams(const glm::ivec3& grid_size) : grid_size_(grid_size), brick_grid_((grid_size + 7) / 8) {
  brick_of_.assign(std::int64_t{brick_grid_.x} * brick_grid_.y * brick_grid_.z, -1);
}

void Seams::cut(const glm::ivec3& lower, int axis) {
  std::int32_t& brick = brick_of_[cell_of(lower)];
  if (brick < 0) {
    brick = static_cast<std::int32_t>(bricks_.size());
    bricks_.push_back({});
  }
  std::uint64_t& slice = bricks_[brick][axis][lower.z & 7];
  const std::uint64_t bit = std::uint64_t{1} << ((lower.x & 7) + 8 * (lower.y & 7));
  size_ += !(slice & bit);
  slice |= bit;
}

void Seams::join(const glm::ivec3& lower, int axis) {
  if (!is_cut(lower, axis)) return;
  bricks_[brick_of_[cell_of(lower)]][axis][lower.z & 7] &= ~(std::uint64_t{1} << ((lower.x & 7) + 8 * (lower.y & 7)));
  --size_;
}

bool Seams::touches(const glm::ivec3& voxel) const {
  for (int direction = 0; direction < 6; ++direction)
    if (is_cut_towards(voxel, direction)) return true;
  return false;
}

bool Seams::is_near_brick(const glm::ivec3& corner) const {
  const glm::ivec3 here = corner >> 3;
  const glm::ivec3 low = glm::max(here - 1, glm::ivec3(0)), high = glm::min(here + 1, brick_grid_ - 1);
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x)
        if (brick_of_[x + std::int64_t{brick_grid_.x} * (y + std::int64_t{brick_grid_.y} * z)] >= 0) return true;
  return false;
}

bool Seams::operator==(const Seams& other) const {
  if (grid_size_ != other.grid_size_ || size_ != other.size_) return false;
  bool same = true;
  for_each([&](const glm::ivec3& lower, int axis) { same = same && other.is_cut(lower, axis); });
  return same;
}

}  // namespace limber
