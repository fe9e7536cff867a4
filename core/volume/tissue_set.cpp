// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/tissue_set.h"

namespace limber {

namespace {

using Brick = std::array<std::uint64_t, 8>;

constexpr std::uint64_t kLowestX = 0x0101010101010101, kHighestX = kLowestX << 7;
constexpr std::uint64_t kLowestY = 0xff, kHighestY = kLowestY << 56;

// Adds all voxels of `within` to `reached` that are connected to `reached` through voxel faces inside this brick.
void spread_inside(Brick& reached, const Brick& within) {
  for (bool grows = true; grows;) {
    grows = false;
    for (int z = 0; z < 8; ++z) {
      const std::uint64_t before = reached[z];
      std::uint64_t around = (before << 1 & ~kLowestX) | (before >> 1 & ~kHighestX) | before << 8 | before >> 8;
      if (z > 0) around |= reached[z - 1];
      if (z < 7) around |= reached[z + 1];
      reached[z] = before | (around & within[z]);
      grows |= reached[z] != before;
    }
  }
}

// Returns the voxels of the neighbouring brick that touch the voxels `here` across the face between the two bricks.
//   direction  0 to 5: towards lower x, higher x, lower y, higher y, lower z, higher z
Brick beyond(const Brick& here, int direction) {
  Brick there{};
  for (int z = 0; z < 8; ++z) switch (direction) {
      case 0: there[z] = (here[z] & kLowestX) << 7; break;
      case 1: there[z] = (here[z] & kHighestX) >> 7; break;
      case 2: there[z] = (here[z] & kLowestY) << 56; break;
      case 3: there[z] = (here[z] & kHighestY) >> 56; break;
      default: break;
    }
  if (direction == 4) there[7] = here[0];
  if (direction == 5) there[0] = here[7];
  return there;
}

}  // namespace

void TissueSet::spread(const TissueSet& within) {
  std::vector<std::int32_t> open(bricks_.size());
  std::vector<bool> is_open(bricks_.size(), true);
  for (std::size_t b = 0; b < open.size(); ++b) open[b] = static_cast<std::int32_t>(b);
  while (!open.empty()) {
    const std::int32_t b = open.back();
    open.pop_back();
    is_open[b] = false;
    spread_inside(bricks_[b], within.bricks_[b]);
    for (int direction = 0; direction < 6; ++direction) {
      glm::ivec3 corner = tissue_.bricks()[b].corner;
      corner[direction >> 1] += direction & 1 ? TissueVoxels::kBrick : -TissueVoxels::kBrick;
      const bool is_inside = glm::all(glm::greaterThanEqual(corner, glm::ivec3(0))) &&
                             glm::all(glm::lessThan(corner, tissue_.grid_size()));
      const int other = is_inside ? tissue_.brick_at(corner) : -1;
      if (other < 0) continue;
      const Brick gained = beyond(bricks_[b], direction);
      bool grows = false;
      for (int z = 0; z < 8; ++z) {
        const std::uint64_t before = bricks_[other][z];
        bricks_[other][z] |= gained[z] & within.bricks_[other][z];
        grows |= bricks_[other][z] != before;
      }
      if (!grows || is_open[other]) continue;
      is_open[other] = true;
      open.push_back(other);
    }
  }
}

}  // namespace limber
