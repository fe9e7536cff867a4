// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/lonely_piece.h"

#include <algorithm>
#include <limits>
#include <unordered_set>
#include <utility>

namespace limber {

namespace {
// The search for bone near a piece ends once it has visited this many voxels.
constexpr std::size_t kMostSeen = 200'000;
// A bone voxel is nearby if it is at most this many times as far from the piece as the nearest bone voxel.
constexpr int kNearby = 2;
// A rig bone is much closer than another if its mean distance is less than this share of the other's.
constexpr float kMuchCloser = 0.5f;
}  // namespace

int bone_of_lonely_piece(const LabelVolume& volume, const TissueVoxels& tissue, std::vector<glm::ivec3> voxels,
                         const std::vector<float>& distance, const std::function<int(std::int64_t)>& bone_at,
                         std::int64_t& budget) {
  std::unordered_set<std::int64_t> seen;
  for (const glm::ivec3& v : voxels) seen.insert(tissue.index_of(v));
  int nearest = -1, closest = -1;  // rig bone of the nearest voxel, and rig bone with the smallest mean distance
  int last = std::numeric_limits<int>::max();
  for (int steps = 1; steps <= last && !voxels.empty() && budget > 0 && seen.size() < kMostSeen; ++steps) {
    std::vector<glm::ivec3> next;
    for (const glm::ivec3& v : voxels)
      for (int direction = 0; direction < 6; ++direction) {
        glm::ivec3 w = v;
        w[direction >> 1] += direction & 1 ? 1 : -1;
        if (volume.at_or_air(w) == 0) continue;
        const std::int64_t place = tissue.index_of(w);
        if (!seen.insert(place).second) continue;
        --budget;
        next.push_back(w);
        const int found = bone_at(place);
        if (found < 0) continue;
        if (nearest < 0) {
          nearest = closest = found;
          last = kNearby * steps;
        }
        if (distance[found] < distance[closest]) closest = found;
      }
    voxels = std::move(next);
  }
  if (nearest < 0) return static_cast<int>(std::min_element(distance.begin(), distance.end()) - distance.begin());
  return distance[closest] < kMuchCloser * distance[nearest] ? closest : nearest;
}

}  // namespace limber
