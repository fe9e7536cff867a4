// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits a project's bone map, in which the user assigns labels of bone tissue to rig bones. The map is kept while
// tissues and rig change, passed to commands as a file, and shown label by label.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/bones/bone_parts.h"
#include "core/rig/joint_names.h"

namespace limber {

// The entries of a bone map that can be used: they name bone tissue and rig bones that exist.
struct FittingBoneMap {
  BoneMap map;
  std::vector<std::string> left_out;  // keys of the entries that cannot be used
};
FittingBoneMap fitting_bone_map(const BoneMap& map, const TissueTable& tissues, const Armature& armature);

// Returns the JSON text of a bone map, which read_bone_map() reads.
std::string to_json(const BoneMap& map);
void write_bone_map(const BoneMap& map, const Path& path);

// A row of the bone map as it is shown to the user: a label of bone tissue, or one side of a label, and the rig bones
// that it follows.
struct MappedLabel {
  Label label = 0;
  // Left or Right if the label's sides follow different rig bones. None: the row is for the whole label.
  std::optional<BodySide> side;
  // Rig bones that the label follows, the bone with the most voxels first. Empty: the label has no voxels in the
  // volume, or none on this side.
  std::vector<int> bones;
  std::int64_t voxels = 0;
  FoundBy found_by = FoundBy::Shape;
  bool is_sure = true;  // false: the rig has no bone that matches the label's name
};
// Returns a row for every label of bone tissue, or for each of its two sides, in the order of the tissue table.
std::vector<MappedLabel> mapped_labels(const BoneParts& parts, const TissueTable& tissues, const Armature& armature,
                                       const BoneMap& map);

// Returns the key of a label in a bone map: its value in files, which is unique, followed by the side if one is given.
std::string map_key(const Tissue& tissue, std::optional<BodySide> side = {});

// Returns a copy of the map in which a label, or one side of it, follows the rig bone named `bone`. If `bone` is null,
// the entry is removed.
BoneMap with_entry(BoneMap map, const Tissue& tissue, std::optional<BodySide> side, const std::string* bone);

}  // namespace limber
