// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/posed_skin.h"

#include <algorithm>
#include <unordered_set>

#include "core/resample/air_pockets.h"
#include "core/resample/neighbourhood.h"
#include "core/resample/skin_at_rest.h"

namespace limber {

namespace {
glm::ivec3 voxel_of(const InnerSkin& skin) { return {skin.voxel[0], skin.voxel[1], skin.voxel[2]}; }
}  // namespace

std::ptrdiff_t drop_covered(const LabelView& posed, std::vector<UnderSkin>& under_skin, std::ptrdiff_t unsure,
                            int low) {
  const auto is_covered = [&](const UnderSkin& voxel) { return !touches_air(posed, voxel_at(posed.grid, voxel.at)); };
  const auto is_below = [&](const UnderSkin& voxel) { return voxel_at(posed.grid, voxel.at).z < low; };
  under_skin.erase(std::remove_if(under_skin.begin() + unsure, under_skin.end(), is_covered), under_skin.end());
  return std::partition_point(under_skin.begin() + unsure, under_skin.end(), is_below) - under_skin.begin();
}

std::int64_t close_skin(LabelEdit posed, const std::vector<UnderSkin>& under_skin, const LabelSet& flesh) {
  std::int64_t closed = 0;
  for (const UnderSkin& voxel : under_skin) {
    const glm::ivec3 v = voxel_at(posed.grid, voxel.at);
    if (voxel.skin == 0 || !flesh[posed.at(v)] || !touches_air(posed, v) || !is_simple_point(posed, v)) continue;
    posed.at(v) = voxel.skin;
    ++closed;
  }
  return closed;
}

std::int64_t thin_skin(LabelEdit posed, std::vector<InnerSkin>& inner_skin, std::int64_t most, const LabelSet& flesh,
                       const LabelSet& skin) {
  if (most == 0) return 0;
  // Orders the heap by depth, deepest first, then by voxel index. Only the few deepest voxels are needed, and a heap
  // finds them faster than a full sort.
  const auto comes_later = [&](const InnerSkin& a, const InnerSkin& b) {
    return a.depth != b.depth ? a.depth < b.depth : posed.grid.index(voxel_of(a)) > posed.grid.index(voxel_of(b));
  };
  std::make_heap(inner_skin.begin(), inner_skin.end(), comes_later);
  std::int64_t given = 0;
  for (auto end = inner_skin.end(); given < most && end != inner_skin.begin(); --end) {
    const glm::ivec3 v = voxel_of(inner_skin.front());
    std::pop_heap(inner_skin.begin(), end, comes_later);
    const Label below = most_common_around(posed, v, 1, flesh);
    if (below == 0 || !skin[posed.at(v)] || touches_air(posed, v) || !is_simple_point(posed, v)) continue;
    posed.at(v) = below;
    ++given;
  }
  return given;
}

std::int64_t cover_bare_flesh(LabelEdit posed, const std::vector<AirPocket>& enclosed,
                              const std::vector<UnderSkin>& under_skin, const LabelSet& flesh, const LabelSet& bone,
                              const LabelSet& skin, std::vector<glm::ivec3>& was_air) {
  std::vector<glm::ivec3> bare, over_bone;
  std::unordered_set<std::int64_t> in_pocket;
  for (const AirPocket& pocket : enclosed)
    for (const glm::ivec3& v : pocket) in_pocket.insert(posed.grid.index(v));
  const auto is_open_air = [&](const glm::ivec3& v) {
    return posed.grid.contains(v) && posed.at(v) == 0 && !in_pocket.contains(posed.grid.index(v));
  };
  // Returns true if a face neighbour of voxel v is air that the body does not enclose, or is outside the grid.
  const auto touches_open_air = [&](const glm::ivec3& v) {
    return std::any_of(kFaceNeighbours.begin(), kFaceNeighbours.end(),
                       [&](const glm::ivec3& step) { return !posed.grid.contains(v + step) || is_open_air(v + step); });
  };
  for (const UnderSkin& voxel : under_skin) {
    const glm::ivec3 v = voxel_at(posed.grid, voxel.at);
    const Label label = posed.at(v);
    if (flesh[label] && touches_open_air(v)) bare.push_back(v);
    if (!bone[label]) continue;
    for (const glm::ivec3& step : kFaceNeighbours)
      if (is_open_air(v + step)) over_bone.push_back(v + step);
  }
  std::unordered_set<std::int64_t> seen;
  std::erase_if(over_bone, [&](const glm::ivec3& v) { return !seen.insert(posed.grid.index(v)).second; });
  bare.insert(bare.end(), over_bone.begin(), over_bone.end());
  const std::int64_t covered = cover_with_skin(posed, std::move(bare), skin);
  std::copy_if(over_bone.begin(), over_bone.end(), std::back_inserter(was_air),
               [&](const glm::ivec3& v) { return posed.at(v) != 0; });
  return covered;
}

}  // namespace limber
