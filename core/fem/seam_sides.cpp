// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/seam_sides.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace limber {

namespace {

// Returns the bone that each tissue voxel follows most, in brick order.
std::vector<std::uint16_t> bone_of_voxels(const TissueVoxels& tissue, const SkinWeights& weights,
                                          const std::vector<int>& moves_as) {
  std::vector<std::uint16_t> bone(tissue.size());
  for (std::int64_t brick = 0; brick < std::ssize(tissue.bricks()); ++brick) {
    auto influence = weights.chunk(brick).begin();
    tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3&) {
      bone[place] = static_cast<std::uint16_t>(moves_as[(*influence++).bone[0]]);
    });
  }
  return bone;
}

// The numbers of voxel faces at which the tissue of two bones touches: those that no seam cuts, and those on a seam.
struct Faces {
  std::int64_t joined = 0, cut = 0;
};

}  // namespace

std::vector<std::uint16_t> sides_of_seams(const TissueVoxels& tissue, const SkinWeights& weights,
                                          const std::vector<int>& moves_as) {
  const Seams* seams = tissue.seams();
  if (!seams) return {};
  const std::size_t count = moves_as.size();
  const std::vector<std::uint16_t> bone = bone_of_voxels(tissue, weights, moves_as);
  std::vector<Faces> between(count * count);
  bool any = false;
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 next = v;
      if (++next[axis] >= seams->grid_size()[axis]) continue;
      const std::int64_t there = tissue.index_of(next);
      if (there < 0 || bone[there] == bone[place]) continue;
      const auto [a, b] = std::minmax(bone[place], bone[there]);
      const bool is_cut = seams->is_cut(v, axis);
      any |= is_cut;
      ++(is_cut ? between[a * count + b].cut : between[a * count + b].joined);
    }
  });
  if (!any) return {};

  std::vector<std::uint16_t> side(count);
  std::iota(side.begin(), side.end(), std::uint16_t{0});
  std::vector<std::tuple<std::int64_t, std::size_t, std::size_t>> joined;  // (-faces, bone, bone)
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = a + 1; b < count; ++b)
      if (const Faces& faces = between[a * count + b]; faces.joined > 0) joined.push_back({-faces.joined, a, b});
  std::sort(joined.begin(), joined.end());
  for (const auto& [faces, first, second] : joined) {
    const auto [kept, lost] = std::minmax(side[first], side[second]);
    if (kept == lost) continue;
    bool are_apart = false;
    for (std::size_t a = 0; a < count && !are_apart; ++a)
      for (std::size_t b = a + 1; b < count && !are_apart; ++b)
        are_apart = between[a * count + b].cut > 0 && std::minmax(side[a], side[b]) == std::minmax(kept, lost);
    if (!are_apart) std::replace(side.begin(), side.end(), std::uint16_t{lost}, std::uint16_t{kept});
  }
  // Numbers the sides of the bones that have tissue without gaps; bones that move as another one share its side.
  std::vector<std::uint16_t> number(count, 0);
  for (std::size_t b = 0; b < count; ++b) side[b] = side[moves_as[b]];
  std::uint16_t next = 0;
  for (std::size_t b = 0; b < count; ++b)
    if (side[b] == b) number[b] = next++;
  for (std::uint16_t& each : side) each = number[each];
  return side;
}

}  // namespace limber
