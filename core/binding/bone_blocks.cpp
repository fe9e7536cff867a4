// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/bone_blocks.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/base/parallel.h"

namespace limber {

namespace {
// Time that each bone (right-hand side) of a block adds to the solve in a brick, relative to the time that a brick
// takes independently of the number of bones.
constexpr double kLaneCost = 0.25;

std::int64_t size_of_union(const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b) {
  std::int64_t size = 0;
  for (std::size_t i = 0, j = 0; i < a.size() || j < b.size(); ++size) {
    const bool from_a = j == b.size() || (i < a.size() && a[i] <= b[j]);
    const bool from_b = i == a.size() || (j < b.size() && b[j] <= a[i]);
    i += from_a;
    j += from_b;
  }
  return size;
}
}  // namespace

std::vector<BoneBlock> blocks_of_bones(const std::vector<std::vector<std::int32_t>>& bricks,
                                       const std::function<double(int)>& bytes_of_brick, double most_bytes) {
  std::vector<int> waiting;
  for (int bone = 0; bone < std::ssize(bricks); ++bone)
    if (!bricks[bone].empty()) waiting.push_back(bone);
  std::stable_sort(waiting.begin(), waiting.end(), [&](int a, int b) { return bricks[a].size() > bricks[b].size(); });

  std::vector<BoneBlock> blocks;
  std::vector<std::int64_t> joined(bricks.size());  // number of bricks of the block with each waiting bone added
  while (!waiting.empty()) {
    BoneBlock block{{waiting.front()}, bricks[waiting.front()]};
    waiting.erase(waiting.begin());
    while (std::ssize(block.bones) < kMostBonesTogether) {
      parallel_for(std::ssize(waiting), 1, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t k = begin; k < end; ++k) joined[k] = size_of_union(block.bricks, bricks[waiting[k]]);
      });
      // Finds the bone that saves the most work by joining this block instead of starting a block of its own.
      double best_gain = 0;
      size_t best = waiting.size();
      for (size_t k = 0; k < waiting.size(); ++k) {
        const double lanes = std::ssize(block.bones), both = joined[k];
        const double apart =
            block.bricks.size() * (1 + kLaneCost * lanes) + bricks[waiting[k]].size() * (1 + kLaneCost);
        if (both * bytes_of_brick(static_cast<int>(lanes) + 1) > most_bytes) continue;
        const double together = both * (1 + kLaneCost * (lanes + 1));
        if (apart - together > best_gain) {
          best_gain = apart - together;
          best = k;
        }
      }
      if (best == waiting.size()) break;
      const std::vector<std::int32_t>& own = bricks[waiting[best]];
      std::vector<std::int32_t> both;
      std::set_union(block.bricks.begin(), block.bricks.end(), own.begin(), own.end(), std::back_inserter(both));
      block.bricks = std::move(both);
      block.bones.push_back(waiting[best]);
      waiting.erase(waiting.begin() + best);
    }
    blocks.push_back(std::move(block));
  }
  return blocks;
}

}  // namespace limber
