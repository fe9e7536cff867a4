// SPDX-License-Identifier: AGPL-3.0-or-later
// Decides which rig bones a label of bone tissue may follow. The user's bone map has precedence. For a label that is
// not in the map, the anatomical meaning of the label's name (anatomical_name.h) is matched with the roles of the rig's
// bones (rig/joint_names.h). If the rig lacks the bone that a name means, the label follows the next rig bone towards
// the trunk: a hand follows the forearm of a rig without hand bones, and a shoulder blade the thorax of a rig without
// collarbones.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/bones/anatomical_name.h"
#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"

namespace limber {

// The bone map, in which the user assigns labels to rig bones. The key is a label's name or value, with or without
// "@left" or "@right"; the value is the name of a rig bone.
using BoneMap = std::map<std::string, std::string>;

// Both functions read a bone map from JSON such as {"Femora, cortical@left": "LeftThigh", "17": "Pelvis"}. They throw
// Error when the text is no bone map or has a key twice.
BoneMap read_bone_map(const Path& path);
BoneMap parse_bone_map(const std::string& bytes, const std::string& where);

enum class FoundBy { Map, Name, Kind, Shape };
std::string_view to_string(FoundBy found_by);

struct LabelBones {
  // Rig bones that the label's tissue may follow on the body's left [0] and right [1]. The two lists are equal if the
  // label has no sides.
  std::array<std::vector<int>, 2> candidates;
  bool has_sides = false;
  // Rig bones that separate the sides of a label with sides: voxels nearer to the bones in [0] are left, voxels nearer
  // to the bones in [1] are right.
  std::array<std::vector<int>, 2> side_bones;
  // true: the label contains one bone of the body (per side), which follows one rig bone as a whole.
  bool single = true;
  FoundBy found_by = FoundBy::Name;
  // true: the rig has neither the bone that the label's name means nor one further towards the trunk. The candidates
  // are then the root bones of the rig.
  bool is_substitute = false;
};

// Returns the labels of bone tissue whose rig bones are known from the map or from the label's name. For all other
// labels, the rig bones must be found by shape. Throws Error when the map names a rig bone or a label that does not
// exist.
std::map<Label, LabelBones> bones_of_labels(const TissueTable& tissues, const Armature& armature,
                                            const BoneMap& map = {});

// Returns the rig bones of a body region on one side. If the rig has none, returns those of the next region towards the
// trunk. Returns none if the names of the rig's bones are not recognised.
std::vector<int> bones_of_region(BoneRegion region, BodySide side, const Armature& armature);

}  // namespace limber
