// SPDX-License-Identifier: AGPL-3.0-or-later
// Assigns bone voxels to rig bones if the labels' names say which bone of the body they are. A label that contains left
// and right is split into its connected components, and a component that contains both sides is split by the nearer
// side of the rig. A single bone of the body is never cut: if it may follow several rig bones (a rib on a rig with two
// thorax bones), its voxels nearest to these rig bones decide for the whole bone, since the bone is attached there.
// Marrow and spongy bone without a name follow the named bone around them.
#pragma once

#include <map>
#include <vector>

#include "core/bones/bone_identity.h"
#include "core/bones/bone_watershed.h"

namespace limber {

struct NamedBones {
  ZeroedVector<int> bone;  // rig bone of each voxel of the graph; -1: must be found by shape
  // Index in `candidates` for each voxel of the graph. Voxels with different indices (groups) belong to different
  // bones.
  ZeroedVector<std::int32_t> group;
  std::vector<std::vector<int>> candidates;  // for each group, the rig bones that it may follow; empty: any
  ZeroedVector<FoundBy> found_by;            // how the rig bone of each voxel of the graph was found
  static constexpr std::int32_t kUnnamed = 0;
};

NamedBones assign_named_bones(const BoneGraph& graph, const LabelVolume& volume, const std::vector<TissueKind>& kinds,
                              const Armature& armature, const std::map<Label, LabelBones>& labels);

// The voxels whose rig bones are not known from names. Their graph has no edges between different groups.
struct Unsettled {
  BoneGraph graph;
  std::vector<std::int32_t> from;  // for each voxel of this graph, its index in the whole graph
};
Unsettled unsettled_part(const BoneGraph& whole, const NamedBones& named);

}  // namespace limber
