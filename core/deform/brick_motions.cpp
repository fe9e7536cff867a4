// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/brick_motions.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"

namespace limber {

namespace {

constexpr int kSeveral = BrickMotions::kSeveral;

// Returns, for each bone, the first bone that has the same motion, up to rounding errors.
std::vector<int> first_alike(const std::vector<RigidTransform>& motions) {
  const auto alike = [](const RigidTransform& a, const RigidTransform& b) {
    const double turn = std::abs(glm::dot(a.rotation, b.rotation));
    const glm::dquat off = glm::dot(a.rotation, b.rotation) < 0 ? a.rotation + b.rotation : a.rotation - b.rotation;
    return turn > 0.5 && glm::length(off) < 1e-13 && glm::length(a.translation - b.translation) < 1e-10;
  };
  std::vector<int> first(motions.size());
  for (int i = 0; i < std::ssize(motions); ++i) {
    first[i] = i;
    for (int k = 0; k < i && first[i] == i; ++k)
      if (first[k] == k && alike(motions[k], motions[i])) first[i] = k;
  }
  return first;
}

// Returns the one bone whose motion all voxels of a brick follow, or kSeveral if they follow different motions.
//   chunk  influences of the brick's voxels
int motion_of_all(const SkinWeights::Chunk& chunk, const std::vector<int>& moves_as) {
  const int first = moves_as[chunk.front().bone[0]];
  const bool same = std::all_of(chunk.begin(), chunk.end(), [&](const Influence& influence) {
    for (int i = 0; i < 4 && influence.weight[i]; ++i)
      if (moves_as[influence.bone[i]] != first) return false;
    return true;
  });
  return same ? first : kSeveral;
}

// Calls body(brick) for a brick and for each of its 26 neighbours that contains tissue.
template <class Body>
void for_each_around(const TissueVoxels& tissue, std::int64_t brick, const Body& body) {
  const glm::ivec3 here = tissue.bricks()[brick].corner / TissueVoxels::kBrick;
  const glm::ivec3 low = glm::max(here - 1, glm::ivec3(0)), high = glm::min(here + 1, tissue.brick_grid() - 1);
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x)
        if (const int near = tissue.brick_at(glm::ivec3(x, y, z) * TissueVoxels::kBrick); near >= 0) body(near);
}

}  // namespace

BrickMotions::BrickMotions(const TissueVoxels& tissue, const SkinWeights& weights,
                           const std::vector<RigidTransform>& posed_from_rest)
    : moves_as(first_alike(posed_from_rest)) {
  const std::int64_t count = std::ssize(tissue.bricks());
  std::vector<int> own(count);
  parallel_for(count, 64, [&](std::int64_t begin, std::int64_t end) {
    for (auto brick = begin; brick < end; ++brick) own[brick] = motion_of_all(weights.chunk(brick), moves_as);
  });
  around.resize(count);
  parallel_for(count, 64, [&](std::int64_t begin, std::int64_t end) {
    for (auto brick = begin; brick < end; ++brick) {
      bool same = own[brick] != kSeveral;
      if (same) for_each_around(tissue, brick, [&](int near) { same &= own[near] == own[brick]; });
      around[brick] = same ? own[brick] : kSeveral;
    }
  });
}

}  // namespace limber
