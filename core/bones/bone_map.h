// SPDX-License-Identifier: AGPL-3.0-or-later
// Bone maps of a project: kept while tissues and rig change, handed to commands as files, and shown label by label.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/bones/bone_parts.h"
#include "core/rig/joint_names.h"

namespace limber {

// What of a map names bone tissue and bones that are there, and can be used. The rest is in `left_out`, by its key.
struct FittingBoneMap {
  BoneMap map;
  std::vector<std::string> left_out;
};
FittingBoneMap fitting_bone_map(const BoneMap& map, const TissueTable& tissues, const Armature& armature);

// As read_bone_map() reads it.
std::string to_json(const BoneMap& map);
void write_bone_map(const BoneMap& map, const Path& path);

// A label of bone tissue, or one side of it, with the rig bones that it follows.
struct MappedLabel {
  Label label = 0;
  std::optional<BodySide> side;  // where the label's two sides follow bones of their own: left or right
  std::vector<int> bones;        // those that it follows, by most voxels; empty: it has no voxels there
  std::int64_t voxels = 0;
  FoundBy found_by = FoundBy::Shape;
  bool is_sure = true;  // the rig has a bone for what the label's name means
};
// Every label of bone tissue in the order of the table, left before right.
std::vector<MappedLabel> mapped_labels(const BoneParts& parts, const TissueTable& tissues, const Armature& armature,
                                       const BoneMap& map);

// The key of a label in a map: its value in files, which no other tissue shares.
std::string map_key(const Tissue& tissue, std::optional<BodySide> side = {});

// The map that says that a label, or one side of it, follows a bone; without a bone, that it says nothing of it.
BoneMap with_entry(BoneMap map, const Tissue& tissue, std::optional<BodySide> side, const std::string* bone);

}  // namespace limber
