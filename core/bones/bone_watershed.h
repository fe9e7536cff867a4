// SPDX-License-Identifier: AGPL-3.0-or-later
// Bone tissue as a graph of voxels, and its basins: a watershed on the bone's depth, grown from its deepest points
// (with marrow from the marrow cores) outwards, cuts the one blob that all bones of a limb often are where it is thin
// [Vincent & Soille 1991, on a priority queue].
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/zeroed_vector.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// The bone voxels and which of their 26 neighbours are bone of the same connected tissue.
struct BoneGraph {
  std::vector<std::int64_t> place;  // in the tissue list
  std::vector<glm::ivec3> voxel;
  ZeroedVector<std::array<std::int32_t, 26>> neighbour;  // place in this list, kNotBone or kOutside
  std::int64_t size() const { return std::ssize(place); }
  // Makes room for so many voxels, which threads are going to fill.
  void resize(std::int64_t count);
};
constexpr std::int32_t kNotBone = -1, kOutside = -2;

BoneGraph gather_bone(const LabelVolume& volume, const TissueVoxels& tissue, const std::vector<TissueKind>& kinds);

// Distance in mm of every bone voxel to the nearest voxel that is not its bone. Beyond the grid the bone goes on.
std::vector<float> bone_depth(const BoneGraph& graph, const glm::dvec3& spacing);
// The same where connections of the graph were removed since: `at_borders` are the voxels that lost some.
void lower_depth(const BoneGraph& graph, const glm::dvec3& spacing, const std::vector<std::int32_t>& at_borders,
                 std::vector<float>& depth);

// The basin of every voxel, numbered from 0: a summit of `height` and what slopes up to it. Where two meet, the lower
// one is a mere wiggle of the higher when the pass between them is nearly as high as its summit; then they are one.
//   wiggle  mm of height that voxels make of a smooth ridge
std::vector<std::int32_t> flood(const BoneGraph& graph, const std::vector<float>& height, double wiggle);

// Basins of fewer than `fewest` voxels join the neighbouring basin they share most faces with.
void join_specks(const BoneGraph& graph, std::int64_t fewest, std::vector<std::int32_t>& basin);

// The voxels of every basin.
std::vector<std::vector<std::int32_t>> members_of(const std::vector<std::int32_t>& basin);

}  // namespace limber
