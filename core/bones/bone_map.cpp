// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/bone_map.h"

#include <algorithm>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "core/base/error.h"

namespace limber {

namespace {

constexpr const char* kSides[] = {"@left", "@right"};

bool can_be_used(const BoneMap& map, const TissueTable& tissues, const Armature& armature) {
  try {
    bones_of_labels(tissues, armature, map);
    return true;
  } catch (const Error&) {
    return false;
  }
}

// Returns true if a rig bone belongs to side `side` (0 left, 1 right) of a label with sides.
bool is_of_side(const LabelBones& bones, int side, int bone) {
  const auto has = [&](int which) {
    return std::find(bones.candidates[which].begin(), bones.candidates[which].end(), bone) !=
           bones.candidates[which].end();
  };
  return has(side) || (!has(1 - side) && side == 0);
}

MappedLabel mapped(const BoneParts& parts, Label label, const LabelBones* bones, std::optional<BodySide> side) {
  MappedLabel row{.label = label, .side = side};
  if (bones) row.found_by = bones->found_by, row.is_sure = !bones->is_substitute;
  std::vector<std::pair<std::int64_t, int>> followed;
  for (const BoneParts::Identity& identity : parts.identities) {
    if (identity.label != label || (side && !is_of_side(*bones, *side == BodySide::Left ? 0 : 1, identity.bone)))
      continue;
    followed.push_back({-identity.voxel_count, identity.bone});
    row.voxels += identity.voxel_count;
    row.found_by = identity.found_by;
    row.is_sure = !identity.is_substitute;
  }
  std::sort(followed.begin(), followed.end());
  for (const auto& [voxels, bone] : followed) row.bones.push_back(bone);
  return row;
}

}  // namespace

// Adds the map's entries one by one, and keeps each entry that can be used together with those kept before. If the
// entry for one side of a label cannot be used alone, the entry for the other side is added with it.
FittingBoneMap fitting_bone_map(const BoneMap& map, const TissueTable& tissues, const Armature& armature) {
  FittingBoneMap fitting{map, {}};
  if (can_be_used(map, tissues, armature)) return fitting;
  fitting.map.clear();
  for (const auto& [key, bone] : map) {
    BoneMap more = fitting.map;
    more[key] = bone;
    if (const std::size_t at = key.rfind('@'); at != key.npos && !can_be_used(more, tissues, armature))
      for (const char* side : kSides)
        if (const auto other = map.find(key.substr(0, at) + side); other != map.end())
          more[other->first] = other->second;
    if (can_be_used(more, tissues, armature)) fitting.map = std::move(more);
  }
  for (const auto& [key, bone] : map)
    if (!fitting.map.contains(key)) fitting.left_out.push_back(key);
  return fitting;
}

std::string to_json(const BoneMap& map) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& [label, bone] : map) json[label] = bone;
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void write_bone_map(const BoneMap& map, const Path& path) { write_file_atomically(path, to_json(map)); }

std::vector<MappedLabel> mapped_labels(const BoneParts& parts, const TissueTable& tissues, const Armature& armature,
                                       const BoneMap& map) {
  const std::map<Label, LabelBones> labels = bones_of_labels(tissues, armature, map);
  std::vector<MappedLabel> rows;
  for (const Tissue& tissue : tissues.tissues) {
    if (!is_bone(tissue.kind)) continue;
    const auto known = labels.find(tissue.label);
    const LabelBones* bones = known == labels.end() ? nullptr : &known->second;
    if (bones && bones->has_sides)
      for (const BodySide side : {BodySide::Left, BodySide::Right})
        rows.push_back(mapped(parts, tissue.label, bones, side));
    else rows.push_back(mapped(parts, tissue.label, bones, std::nullopt));
  }
  return rows;
}

std::string map_key(const Tissue& tissue, std::optional<BodySide> side) {
  char value[40];
  std::snprintf(value, sizeof value, "%.15g", tissue.file_value);
  return std::string(value) + (!side ? "" : kSides[*side == BodySide::Left ? 0 : 1]);
}

BoneMap with_entry(BoneMap map, const Tissue& tissue, std::optional<BodySide> side, const std::string* bone) {
  for (const std::string& label : {map_key(tissue), tissue.name}) {
    const std::string sided = side ? label + kSides[*side == BodySide::Left ? 0 : 1] : label;
    map.erase(sided);
    // An entry for a whole label replaces the entries for its two sides. An entry for one side also splits an existing
    // entry for the whole label: the other side keeps that entry's bone.
    if (!side) map.erase(label + kSides[0]), map.erase(label + kSides[1]);
    else if (const auto whole = map.find(label); whole != map.end()) {
      for (const char* each : kSides) map.try_emplace(map_key(tissue) + each, whole->second);
      map.erase(label);
    }
  }
  if (bone) map[map_key(tissue, side)] = *bone;
  else if (side) map.erase(map_key(tissue, side));
  return map;
}

}  // namespace limber
