// SPDX-License-Identifier: AGPL-3.0-or-later
// Gathers the voxels of bone whose rig bones are known: into connected parts, and into a list of labels and rig bones.
// Both run on several threads and give the same result for any number of threads.
#pragma once

#include <map>
#include <vector>

#include "core/bones/bone_parts.h"
#include "core/bones/bone_watershed.h"
#include "core/bones/hugging.h"
#include "core/bones/named_bones.h"

namespace limber {

// Groups the voxels that follow the same rig bone and are connected into parts, which it adds to `result`. A part
// smaller than a hundredth of its rig bone's largest part is added to that part.
//   bone  rig bone of each voxel of the graph
void gather_parts(const BoneGraph& graph, const Hugging& hugging, const ZeroedVector<int>& bone, BoneParts& result);

// Returns which rig bones the voxels of each label follow.
//   named   the rig bone of every voxel of the graph, and how it was found
//   labels  the bones that the names of labels mean
std::vector<BoneParts::Identity> identities_of(const BoneGraph& graph, const LabelVolume& volume,
                                               const NamedBones& named, const std::map<Label, LabelBones>& labels);

}  // namespace limber
