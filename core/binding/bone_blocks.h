// SPDX-License-Identifier: AGPL-3.0-or-later
// Groups bones into blocks. The heat of all bones of a block is solved for together. A bone has weight only in a part
// of the body, so solving bones together saves time if they share most of their bricks (blocks of 8^3 voxels).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace limber {

// A group of bones that are solved together, and the bricks in which any of these bones has weight, ascending.
struct BoneBlock {
  std::vector<int> bones;
  std::vector<std::int32_t> bricks;
};

constexpr int kMostBonesTogether = 4;

// Groups the bones. Each block starts with the remaining bone that has the most bricks. Bones that share many bricks
// with the block are added to it, up to kMostBonesTogether.
//   bricks          bricks in which each bone has weight, ascending
//   bytes_of_brick  returns the memory of a brick, in bytes, if the given number of bones is solved for together
//   most_bytes      memory limit of a block of several bones
std::vector<BoneBlock> blocks_of_bones(const std::vector<std::vector<std::int32_t>>& bricks,
                                       const std::function<double(int)>& bytes_of_brick, double most_bytes);

}  // namespace limber
