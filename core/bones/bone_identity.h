// SPDX-License-Identifier: AGPL-3.0-or-later
// Decides which rig bones a label of bone tissue may follow. What the user's bone map says counts first, then the
// label's name read as anatomy (anatomical_name.h) and matched with the roles of the rig's bones (rig/joint_names.h).
// Where the rig lacks the bone that a name means, the label follows the next bone towards the trunk that the rig has: a
// hand without a hand bone follows the forearm, a shoulder blade without a collarbone the thorax.
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

// What the user says: a label's name or value, alone or with "@left" or "@right", to the name of a rig bone.
using BoneMap = std::map<std::string, std::string>;

// JSON: {"Femora, cortical@left": "LeftThigh", "17": "Pelvis"}. Throws Error for what is no such file, and for a key
// that is there twice.
BoneMap read_bone_map(const Path& path);
BoneMap parse_bone_map(const std::string& bytes, const std::string& where);

enum class FoundBy { Map, Name, Kind, Shape };
std::string_view to_string(FoundBy found_by);

struct LabelBones {
  // Rig bones that the label's tissue may follow on the body's left and on its right; the same where it has no sides.
  std::array<std::vector<int>, 2> candidates;
  bool has_sides = false;
  std::array<std::vector<int>, 2> side_bones;  // where it has: what lies nearer to the first is left
  bool single = true;  // one bone of the body, that must follow one rig bone whole (on each side)
  FoundBy found_by = FoundBy::Name;
  bool is_substitute =
      false;  // the rig has neither what the name means nor anything towards the trunk: its roots stand in
};

// The labels of bone tissue whose rig bones are known; one that is not there must be found by its shape.
// throws Error where the map names a rig bone or a label that is not there
std::map<Label, LabelBones> bones_of_labels(const TissueTable& tissues, const Armature& armature,
                                            const BoneMap& map = {});

// The rig bones of a region of the body on one side, or where the rig has none of it, the next towards the trunk. None
// where the rig's names say nothing of it.
std::vector<int> bones_of_region(BoneRegion region, BodySide side, const Armature& armature);

}  // namespace limber
