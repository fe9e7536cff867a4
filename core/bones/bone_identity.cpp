// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/bone_identity.h"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <set>

#include <nlohmann/json.hpp>

#include "core/base/error.h"

namespace limber {

namespace {
constexpr std::uint64_t kLargestMap = 1 << 20;  // bytes; a larger bone map file is refused

// Finds the rig bones that belong to a region of the body, by the meaning of the bones' names.
class RigRegions {
 public:
  explicit RigRegions(const Armature& armature) {
    std::vector<std::string> names;
    std::vector<int> parents;
    for (const Bone& bone : armature.bones) names.push_back(bone.name), parents.push_back(bone.parent);
    roles_ = joint_roles(names, parents);
    for (int b = 0; b < std::ssize(roles_); ++b) {
      if (parents[b] < 0) roots_.push_back(b);
      // In a rig without a neck, the bones of the trunk get no roles. So their own names decide.
      if (roles_[b] && roles_[b]->part != BodyPart::Spine) continue;
      const AnatomicalName name = anatomical_name(names[b]);
      const std::string plain = plain_name(names[b]);
      const auto says = [&](std::initializer_list<const char*> words) {
        return std::any_of(words.begin(), words.end(),
                           [&](const char* word) { return plain.find(word) != plain.npos; });
      };
      if (name.regions.contains(BoneRegion::Thorax) || says({"thorax", "chest"})) thorax_.push_back(b);
      else if (name.regions.contains(BoneRegion::Lumbar) || says({"lumbar", "lowerback", "abdomen", "waist"}))
        lumbar_.push_back(b);
    }
  }

  // Returns true if at least one rig bone has a known role.
  bool is_recognised() const {
    return std::count_if(roles_.begin(), roles_.end(), [](const auto& role) { return role.has_value(); }) > 0;
  }

  // Returns all rig bones on one side of the body.
  std::vector<int> of_side(BodySide side) const {
    return with_role([&](const JointRole& role) { return role.side == side; });
  }

  struct Found {
    std::vector<int> bones;
    bool is_substitute = false;
  };
  Found find(BoneRegion region, const AnatomicalName& name, BodySide side) const {
    if (auto bones = own(region, name, side); !bones.empty()) return {std::move(bones), false};
    for (std::optional<BoneRegion> next = towards_trunk(region); next; next = towards_trunk(*next))
      if (auto bones = own(*next, AnatomicalName{}, side); !bones.empty()) return {std::move(bones), false};
    return {roots_, true};
  }

 private:
  static std::optional<BoneRegion> towards_trunk(BoneRegion region) {
    using enum BoneRegion;
    switch (region) {
      case Head: return Neck;
      case Neck: return Thorax;
      case Thorax: return Lumbar;
      case Lumbar:
      case Spine:
      case Thigh: return Pelvis;
      case Pelvis: return std::nullopt;
      case Shoulder: return Thorax;
      case UpperArm: return Shoulder;
      case Forearm: return UpperArm;
      case Hand: return Forearm;
      case Finger: return Hand;
      case Shank: return Thigh;
      case Foot: return Shank;
      case Toes: return Foot;
    }
    return std::nullopt;
  }

  template <class Fits>
  std::vector<int> with_role(const Fits& fits) const {
    std::vector<int> bones;
    for (int b = 0; b < std::ssize(roles_); ++b)
      if (roles_[b] && fits(*roles_[b])) bones.push_back(b);
    return bones;
  }
  std::vector<int> of_part(BodyPart part, BodySide side) const {
    // The bone names of a rig of a single limb possibly contain no side.
    auto bones = with_role([&](const JointRole& role) { return role.part == part && role.side == side; });
    if (bones.empty() && side != BodySide::Middle)
      bones = with_role([&](const JointRole& role) { return role.part == part && role.side == BodySide::Middle; });
    return bones;
  }
  // Returns the rig bones `meant`. If there are none, returns the bones of the spine without `others`; if none are
  // left, the whole spine.
  std::vector<int> of_spine(const std::vector<int>& meant, const std::vector<int>& others) const {
    if (!meant.empty()) return meant;
    std::vector<int> spine = of_part(BodyPart::Spine, BodySide::Middle), rest;
    for (const int b : spine)
      if (std::find(others.begin(), others.end(), b) == others.end()) rest.push_back(b);
    return rest.empty() ? spine : rest;
  }

  static bool is_finger(BodyPart part) { return part >= BodyPart::Thumb && part <= BodyPart::Little; }

  // Returns the rig bones of a finger's segment. If the rig lacks the segment, returns those of the next segment
  // towards the hand that the rig has.
  std::vector<int> of_finger(const AnatomicalName& name, BodySide side) const {
    const bool all_fingers = name.finger == BodyPart::Fingers;
    const auto of_segments = [&](int lowest, int highest) {
      return with_role([&](const JointRole& role) {
        return role.side == side && is_finger(role.part) && (all_fingers || role.part == name.finger) &&
               role.index >= lowest && role.index <= highest;
      });
    };
    if (name.segment < 0) return of_segments(0, 3);
    for (int segment = name.segment; segment >= 0; --segment)
      if (auto bones = of_segments(segment, segment); !bones.empty()) return bones;
    return name.segment > 0 ? of_part(BodyPart::Fingers, side) : std::vector<int>();
  }

  std::vector<int> own(BoneRegion region, const AnatomicalName& name, BodySide side) const {
    using enum BoneRegion;
    switch (region) {
      case Head: return of_part(BodyPart::Head, BodySide::Middle);
      case Neck: return of_part(BodyPart::Neck, BodySide::Middle);
      case Thorax: return of_spine(thorax_, lumbar_);
      case Lumbar: return of_spine(lumbar_, thorax_);
      case Spine: {
        auto bones = of_part(BodyPart::Spine, BodySide::Middle);
        for (const int b : of_part(BodyPart::Neck, BodySide::Middle)) bones.push_back(b);
        return bones;
      }
      case Pelvis: return of_part(BodyPart::Pelvis, BodySide::Middle);
      case Shoulder: return of_part(BodyPart::Clavicle, side);
      case UpperArm: return of_part(BodyPart::UpperArm, side);
      case Forearm: return of_part(BodyPart::Forearm, side);
      case Hand: return of_part(BodyPart::Hand, side);
      case Finger: return of_finger(name, side);
      case Thigh: return of_part(BodyPart::Thigh, side);
      case Shank: return of_part(BodyPart::Shank, side);
      case Foot: return of_part(BodyPart::Foot, side);
      case Toes: return of_part(BodyPart::Toes, side);
    }
    return {};
  }

  std::vector<std::optional<JointRole>> roles_;
  std::vector<int> roots_, thorax_, lumbar_;
};

bool has_sides(BoneRegion region) { return region >= BoneRegion::Shoulder; }

std::optional<LabelBones> bones_by_name(const AnatomicalName& name, const RigRegions& rig) {
  if (name.regions.empty()) return std::nullopt;
  LabelBones found;
  found.has_sides = name.side == BodySide::Middle && std::any_of(name.regions.begin(), name.regions.end(), has_sides);
  found.single = !name.plural;
  for (int side = 0; side < 2; ++side) {
    std::set<int> bones;
    const BodySide own = side == 0 ? BodySide::Left : BodySide::Right;
    for (const BoneRegion region : name.regions) {
      const auto in_rig = rig.find(region, name, name.side == BodySide::Middle ? own : name.side);
      // A label that holds several bones (a hand with its fingers) may follow the rig bones of all its regions.
      bones.insert(in_rig.bones.begin(), in_rig.bones.end());
      found.is_substitute |= in_rig.is_substitute;
    }
    found.candidates[side].assign(bones.begin(), bones.end());
  }
  found.has_sides &= found.candidates[0] != found.candidates[1];
  found.side_bones = found.candidates;
  return found;
}

// --- reading the user's bone map

int bone_named(const Armature& armature, const std::string& name, const std::string& key) {
  for (int b = 0; b < std::ssize(armature.bones); ++b)
    if (armature.bones[b].name == name) return b;
  throw Error("the rig has no bone \"" + name.substr(0, 80) + "\"", "bone map, \"" + key.substr(0, 80) + "\"",
              "name a bone of the rig");
}

struct MapKey {
  std::string label;
  std::optional<int> side;  // 0: left, 1: right, none: the whole label
};
MapKey parts_of(const std::string& key) {
  const auto at = key.rfind('@');
  if (at == key.npos) return {key, std::nullopt};
  const std::string side = key.substr(at + 1);
  if (side == "left") return {key.substr(0, at), 0};
  if (side == "right") return {key.substr(0, at), 1};
  return {key, std::nullopt};
}

bool is_meant(const Tissue& tissue, const std::string& label) {
  if (tissue.name == label) return true;
  char value[40];
  std::snprintf(value, sizeof value, "%.15g", tissue.file_value);
  return label == value;
}

void apply(const BoneMap& map, const TissueTable& tissues, const Armature& armature, const RigRegions& rig,
           std::map<Label, LabelBones>& found) {
  // Applies entries for whole labels first. Entries for one side follow, because they override the entry for the whole
  // label.
  for (const bool of_sides : {false, true})
    for (const auto& [key, bone_name] : map) {
      const MapKey parts = parts_of(key);
      if (parts.side.has_value() != of_sides) continue;
      const int bone = bone_named(armature, bone_name, key);
      bool any = false;
      for (const Tissue& tissue : tissues.tissues) {
        if (!is_bone(tissue.kind) || !is_meant(tissue, parts.label)) continue;
        any = true;
        LabelBones& bones = found[tissue.label];
        bones.found_by = FoundBy::Map;
        bones.is_substitute = false;
        bones.single = true;
        bones.has_sides = of_sides;
        if (of_sides) {
          bones.side_bones = {rig.of_side(BodySide::Left), rig.of_side(BodySide::Right)};
          if (bones.side_bones[0].empty() || bones.side_bones[1].empty())
            throw Error("the rig's names do not tell left from right", "bone map, \"" + key.substr(0, 80) + "\"",
                        "leave @left and @right out, or name the rig's bones by their side");
        }
        for (int side = 0; side < 2; ++side)
          if (!of_sides || side == *parts.side) bones.candidates[side] = {bone};
      }
      if (!any)
        throw Error("the volume has no bone tissue \"" + parts.label.substr(0, 80) + "\"", "bone map",
                    "write a label's name or value as `limber info` shows it");
    }
  for (const auto& [label, bones] : found)
    for (int side = 0; side < 2; ++side)
      if (bones.candidates[side].empty()) {
        const Tissue* tissue = tissues.find(label);
        throw Error("the bone map has only one side of the label \"" +
                        (tissue ? tissue->name.substr(0, 80) : std::string()) +
                        "\", and the label's name does not give the other side",
                    "bone map", side == 0 ? "add the label with @left" : "add the label with @right");
      }
}
}  // namespace

BoneMap parse_bone_map(const std::string& bytes, const std::string& where) {
  const auto wrong = [&](const std::string& what) {
    return Error(what, where, "write {\"label or label@left\": \"rig bone\"}");
  };
  BoneMap map;
  std::string twice;
  std::set<std::string> keys;
  using Json = nlohmann::json;
  // The parser would silently keep only the last of two equal keys, so keys are counted while parsing.
  const auto note_keys = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start || event == Json::parse_event_t::array_start) {
      if (depth >= 1) throw wrong("the bone map is nested");
    }
    if (event == Json::parse_event_t::key && !keys.insert(parsed.get<std::string>()).second)
      twice = parsed.get<std::string>();
    return true;
  };
  const Json json = Json::parse(bytes, note_keys, false);
  if (!json.is_object()) throw wrong("this is not a bone map");
  if (!twice.empty()) throw wrong("the bone map has the label \"" + twice.substr(0, 80) + "\" twice");
  for (const auto& [key, value] : json.items()) {
    if (!value.is_string())
      throw wrong("the bone map gives the label \"" + key.substr(0, 80) + "\" no name of a rig bone");
    map[key] = value.get<std::string>();
  }
  return map;
}

BoneMap read_bone_map(const Path& path) { return parse_bone_map(read_file(path, kLargestMap), path.string()); }

std::string_view to_string(FoundBy found_by) {
  switch (found_by) {
    case FoundBy::Map: return "bone map";
    case FoundBy::Name: return "name";
    case FoundBy::Kind: return "marrow";
    case FoundBy::Shape: return "shape";
  }
  return "";
}

std::vector<int> bones_of_region(BoneRegion region, BodySide side, const Armature& armature) {
  const RigRegions rig(armature);
  if (!rig.is_recognised()) return {};
  const auto found = rig.find(region, AnatomicalName{}, side);
  return found.is_substitute ? std::vector<int>() : found.bones;
}

std::map<Label, LabelBones> bones_of_labels(const TissueTable& tissues, const Armature& armature, const BoneMap& map) {
  const RigRegions rig(armature);
  std::map<Label, LabelBones> found;
  if (rig.is_recognised())
    for (const Tissue& tissue : tissues.tissues)
      if (is_bone(tissue.kind))
        if (auto bones = bones_by_name(anatomical_name(tissue.name), rig)) found[tissue.label] = std::move(*bones);
  apply(map, tissues, armature, rig, found);
  return found;
}

}  // namespace limber
