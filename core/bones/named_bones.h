// SPDX-License-Identifier: AGPL-3.0-or-later
// Gives bone voxels whose labels say which bone of the body they are to their rig bones. A label with left and right in
// one is parted by its connected pieces, or where one piece holds both by the nearer side of the rig. One bone of the
// body is never cut: where several rig bones may carry it (a rib on a rig with two thoraces), those of its voxels that
// lie nearest to them decide for all, since that is where it is attached. Marrow and spongy bone without a name follow
// the named bone that they lie in.
#pragma once

#include <map>
#include <vector>

#include "core/bones/bone_identity.h"
#include "core/bones/bone_watershed.h"

namespace limber {

struct NamedBones {
  std::vector<int> bone;            // #graph, rig bone; -1 where shape must tell
  std::vector<std::int32_t> group;  // #graph, into `candidates`: voxels of different groups are different bones
  std::vector<std::vector<int>> candidates;  // by group: the rig bones it may follow; none means any
  std::vector<FoundBy> found_by;             // #graph
  static constexpr std::int32_t kUnnamed = 0;
};

NamedBones assign_named_bones(const BoneGraph& graph, const LabelVolume& volume, const std::vector<TissueKind>& kinds,
                              const Armature& armature, const std::map<Label, LabelBones>& labels);

// The part of the graph that names do not decide. Voxels of different groups are not neighbours there.
struct Unsettled {
  BoneGraph graph;
  std::vector<std::int32_t> from;  // #graph, in the whole one
};
Unsettled unsettled_part(const BoneGraph& whole, const NamedBones& named);

}  // namespace limber
