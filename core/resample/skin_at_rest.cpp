// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/skin_at_rest.h"

#include <algorithm>
#include <map>

#include "core/resample/air_pockets.h"

namespace limber {

namespace {

// Skin beside a voxel counts as lying over the voxel only if the voxel is at most this deep below air, in voxels of the
// largest spacing. Deeper voxels cannot touch the underside of thin skin.
constexpr double kSkinReach = 3;
// Largest distance, in voxels, at which skin is searched to cover a bare voxel. A voxel without skin up to there stays
// bare.
constexpr int kFurthestSkin = 8;
// A volume counts as coarse slices if its largest voxel spacing is more than this many times its smallest.
constexpr double kCoarse = 2;
// Skin counts as closed if the body's surface has more than this many skin voxels per voxel of bare flesh.
constexpr int kClosed = 9;

// Returns the voxel that contains a rest point. Rounds by truncation, which is faster than std::floor and suffices
// since rest points are in tissue, so not far below 0.
glm::ivec3 voxel_of(const glm::dvec3& rest_point) { return glm::ivec3(rest_point + 1.5) - 1; }

}  // namespace

SkinAtRest::SkinAtRest(const LabelView& volume, const TissueVoxels& tissue, const TissueDepth& depth,
                       const LabelSet& soft, const LabelSet& skin)
    : volume_(volume),
      tissue_(tissue),
      depth_(depth),
      soft_(soft),
      skin_(skin),
      air_pockets_(air_pockets(volume)),
      skin_reach_(kSkinReach * std::max({volume.grid.spacing.x, volume.grid.spacing.y, volume.grid.spacing.z})),
      deep_(glm::length(volume.grid.spacing)) {
  for (const AirPocket& pocket : air_pockets_)
    for (const glm::ivec3& v : pocket) enclosed_air_.insert(volume.grid.index(v));
  const glm::dvec3 s = volume.grid.spacing;
  const bool has_coarse_slices = std::max({s.x, s.y, s.z}) > kCoarse * std::min({s.x, s.y, s.z});
  is_closed_ = !has_coarse_slices || is_mostly_closed();
}

bool SkinAtRest::is_mostly_closed() const {
  std::int64_t skin = 0, bare = 0;
  tissue_.for_each([&](std::int64_t, const glm::ivec3& v) {
    const Label label = volume_.at(v);
    if (soft_[label] && touches_air(volume_, v) && touches_outside(v)) ++(skin_[label] ? skin : bare);
  });
  return skin > kClosed * bare;
}

bool SkinAtRest::touches_outside(const glm::ivec3& voxel) const {
  bool outside = false;
  for (const glm::ivec3& step : kFaceNeighbours) {
    const glm::ivec3 beside = voxel + step;
    outside |= !volume_.grid.contains(beside) ||
               (volume_.at(beside) == 0 && !enclosed_air_.contains(volume_.grid.index(beside)));
  }
  return outside;
}

bool SkinAtRest::is_bare(const glm::ivec3& voxel) const {
  const Label label = volume_.at_or_air(voxel);
  return label && soft_[label] && !skin_[label] && touches_air(volume_, voxel) && touches_outside(voxel);
}

// Returns true if a voxel is deep below the outside air. Air that the body encloses does not count here, unlike in
// TissueDepth.
bool SkinAtRest::is_deep(const glm::ivec3& voxel) const {
  if (depth_.at_voxel(voxel) > deep_) return true;
  if (enclosed_air_.empty()) return false;
  const glm::dvec3 spacing = volume_.grid.spacing;
  const glm::ivec3 reach(deep_ / spacing);
  for (int z = -reach.z; z <= reach.z; ++z)
    for (int y = -reach.y; y <= reach.y; ++y)
      for (int x = -reach.x; x <= reach.x; ++x) {
        const glm::ivec3 there = voxel + glm::ivec3(x, y, z);
        if (glm::length(glm::dvec3(x, y, z) * spacing) > deep_ || volume_.at_or_air(there)) continue;
        if (!volume_.grid.contains(there) || !enclosed_air_.contains(volume_.grid.index(there))) return false;
      }
  return true;
}

bool SkinAtRest::was_covered(const glm::dvec3& rest_point) const {
  const glm::ivec3 voxel = voxel_of(rest_point);
  const bool at_air = touches_air(volume_, voxel);
  if (at_air ? !touches_outside(voxel) : is_deep(voxel) || was_at_seam(rest_point)) return true;
  if (!is_closed_ || is_bare(voxel)) return false;
  return skin_over(rest_point) || std::none_of(neighbours().begin(), neighbours().end(),
                                               [&](const glm::ivec3& step) { return is_bare(voxel + step); });
}

bool SkinAtRest::was_at_seam(const glm::dvec3& rest_point) const {
  const Seams* seams = tissue_.seams();
  const glm::ivec3 voxel = voxel_of(rest_point);
  return seams && volume_.grid.contains(voxel) && seams->touches(voxel);
}

bool SkinAtRest::was_bone_covered(const glm::dvec3& rest_point) const {
  if (was_at_seam(rest_point) || (is_closed_ && skin_over(rest_point))) return true;
  const glm::ivec3 voxel = voxel_of(rest_point);
  return !touches_air(volume_, voxel) && is_deep(voxel);
}

Label SkinAtRest::skin_over(const glm::dvec3& rest_point) const {
  const glm::ivec3 voxel = voxel_of(rest_point);
  if (depth_.at_voxel(voxel) > skin_reach_ || touches_air(volume_, voxel)) return 0;
  for (const glm::ivec3& step : neighbours())
    if (const Label label = volume_.at_or_air(voxel + step); skin_[label]) return label;
  return 0;
}

std::int64_t cover_with_skin(LabelEdit posed, std::vector<glm::ivec3> bare, const LabelSet& skin) {
  std::int64_t covered = 0;
  // Bare voxels beside skin become skin, layer by layer. If no bare voxel is beside skin, skin is searched further
  // away.
  for (int reach = 1; reach <= kFurthestSkin && !bare.empty();) {
    std::vector<glm::ivec3> left;
    std::vector<std::pair<glm::ivec3, Label>> layer;
    for (const glm::ivec3& v : bare)
      if (const Label label = most_common_around(posed, v, reach, skin)) layer.push_back({v, label});
      else left.push_back(v);
    for (const auto& [v, label] : layer) posed.at(v) = label;
    covered += std::ssize(layer);
    reach = layer.empty() ? reach + 1 : 1;
    bare = std::move(left);
  }
  return covered;
}

Label most_common_around(const LabelView& volume, const glm::ivec3& voxel, int reach, const LabelSet& wanted) {
  std::map<Label, int> counts;
  for (int z = -reach; z <= reach; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x)
        if (const Label label = volume.at_or_air(voxel + glm::ivec3(x, y, z)); label && wanted[label]) ++counts[label];
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == counts.end() ? Label{0} : most->first;
}

}  // namespace limber
