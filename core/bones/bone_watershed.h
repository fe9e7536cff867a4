// SPDX-License-Identifier: AGPL-3.0-or-later
// Builds a graph of the bone voxels and splits it into basins. All bones of a limb are often one connected blob. A
// watershed on the depth inside bone, grown outwards from the deepest points (with marrow, from the marrow cores), cuts
// the blob where it is thin [Vincent & Soille 1991, on a priority queue].
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/zeroed_vector.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// The bone voxels, each with those of its 26 neighbours that are bone and connected to it.
struct BoneGraph {
  ZeroedVector<std::int64_t> place;  // index in the list of tissue voxels
  ZeroedVector<glm::ivec3> voxel;
  ZeroedVector<std::array<std::int32_t, 26>> neighbour;  // index in the graph; kNotBone or kOutside: no neighbour
  std::int64_t size() const { return std::ssize(place); }
  // Allocates `count` voxels, which the caller's threads then fill.
  void resize(std::int64_t count);
};
constexpr std::int32_t kNotBone = -1, kOutside = -2;

BoneGraph gather_bone(const LabelVolume& volume, const TissueVoxels& tissue, const std::vector<TissueKind>& kinds);

// Returns the distance in mm from every bone voxel to the nearest voxel that does not belong to the same bone. Outside
// the grid, bone is assumed to continue.
std::vector<float> bone_depth(const BoneGraph& graph, const glm::dvec3& spacing);
// Lowers `depth` after connections of the graph were removed. `at_borders` lists the voxels that lost connections.
void lower_depth(const BoneGraph& graph, const glm::dvec3& spacing, const std::vector<std::int32_t>& at_borders,
                 std::vector<float>& depth);

// Returns the basin of every voxel, numbered from 0. A basin is a local maximum of `height` (its summit) with all
// voxels from which `height` rises to it. Two basins are merged when the pass between them is nearly as high as the
// lower summit.
//   wiggle  variations of `height` up to this come from rounding to voxels and do not separate basins, mm
std::vector<std::int32_t> flood(const BoneGraph& graph, const std::vector<float>& height, double wiggle);

// Merges each basin of fewer than `fewest` voxels into the neighbouring basin with which it has the most contacts.
void join_specks(const BoneGraph& graph, std::int64_t fewest, std::vector<std::int32_t>& basin);

// Returns for every basin the list of its voxels.
std::vector<std::vector<std::int32_t>> members_of(const std::vector<std::int32_t>& basin);

}  // namespace limber
