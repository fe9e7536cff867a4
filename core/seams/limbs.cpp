// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/seams/limbs.h"

#include <algorithm>
#include <cctype>
#include <string>

#include "core/rig/bone_roles.h"

namespace limber {

namespace {

// Values of Limb::grown_together: the share of a limb's first bone along which the limb's flesh is continuous with the
// body. Armpit and crotch lie a quarter of the way down the bone, the web between fingers half of the way, so the
// shares are a little larger.
constexpr double kLimbGrownTogether = 0.3;
constexpr double kFingerGrownTogether = 0.6;

bool is_digit(BodyPart part) {
  return part == BodyPart::Thumb || part == BodyPart::Index || part == BodyPart::Middle || part == BodyPart::Ring ||
         part == BodyPart::Little;
}

// Returns true if a bone with this role lies in the part of a finger or thumb that is outside the palm.
bool is_free_digit(const JointRole& role) {
  return is_digit(role.part) && role.index >= (role.part == BodyPart::Thumb ? 2 : 1);
}

LimbName limb_name_of(const JointRole& role) {
  switch (role.part) {
    case BodyPart::UpperArm:
    case BodyPart::Forearm:
    case BodyPart::Hand:
    case BodyPart::Palm:
    case BodyPart::Fingers:
    case BodyPart::Thumb:
    case BodyPart::Index:
    case BodyPart::Middle:
    case BodyPart::Ring:
    case BodyPart::Little: return LimbName::Arms;
    case BodyPart::Thigh:
    case BodyPart::Shank:
    case BodyPart::Foot:
    case BodyPart::Toes: return LimbName::Legs;
    case BodyPart::Neck:
    case BodyPart::Head: return LimbName::Head;
    default: return LimbName::Trunk;
  }
}

template <class Belongs>
Limb limb_where(const Armature& armature, const BoneRoles& roles, const Belongs& belongs) {
  Limb limb;
  for (size_t b = 0; b < roles.size(); ++b) {
    limb.has_bone.push_back(roles[b] && belongs(*roles[b]));
    const int parent = armature.bones[b].parent;
    if (limb.has_bone[b] && limb.root < 0 && parent >= 0 && !limb.has_bone[parent]) limb.root = static_cast<int>(b);
  }
  return limb;
}

bool has_any(const Limb& limb) {
  return std::find(limb.has_bone.begin(), limb.has_bone.end(), true) != limb.has_bone.end();
}

Limb arm_or_leg(const Armature& armature, const BoneRoles& roles, LimbName name, BodySide side) {
  Limb limb = limb_where(armature, roles,
                         [&](const JointRole& role) { return limb_name_of(role) == name && role.side == side; });
  limb.grown_together = kLimbGrownTogether;
  for (size_t b = 0; b < roles.size(); ++b) {
    // A leg may not touch the trunk, because the flesh of hip and buttock is continuous with the thigh.
    const bool is_neighbour = name == LimbName::Legs && roles[b] && limb_name_of(*roles[b]) == LimbName::Trunk;
    limb.may_touch.push_back(roles[b] && !limb.has_bone[b] && !is_neighbour);
  }
  return limb;
}

Limb digit(const Armature& armature, const BoneRoles& roles, BodyPart part, BodySide side) {
  Limb limb = limb_where(armature, roles, [&](const JointRole& role) {
    return role.part == part && role.side == side && is_free_digit(role);
  });
  limb.grown_together = kFingerGrownTogether;
  for (size_t b = 0; b < roles.size(); ++b)
    limb.may_touch.push_back(roles[b] && roles[b]->side == side && roles[b]->part != part && is_free_digit(*roles[b]));
  return limb;
}

}  // namespace

std::vector<std::optional<LimbName>> limb_of_bones(const Armature& armature) {
  std::vector<std::optional<LimbName>> names;
  for (const auto& role : inherited_bone_roles(armature))
    names.push_back(role ? std::optional(limb_name_of(*role)) : std::nullopt);
  return names;
}

std::vector<Limb> limbs_of(const Armature& armature) {
  const BoneRoles roles = inherited_bone_roles(armature);
  std::vector<Limb> limbs;
  const auto add = [&](Limb limb) {
    if (has_any(limb)) limbs.push_back(std::move(limb));
  };
  for (const LimbName name : {LimbName::Arms, LimbName::Legs})
    for (const BodySide side : {BodySide::Left, BodySide::Right}) add(arm_or_leg(armature, roles, name, side));
  for (const BodySide side : {BodySide::Left, BodySide::Right})
    for (const BodyPart part : {BodyPart::Thumb, BodyPart::Index, BodyPart::Middle, BodyPart::Ring, BodyPart::Little})
      add(digit(armature, roles, part, side));
  return limbs;
}

bool is_free(const Limb& limb, const Armature& armature, const glm::dvec3& point) {
  int nearest = -1;
  double least = 0;
  for (size_t b = 0; b < armature.bones.size(); ++b) {
    if (!limb.has_bone[b]) continue;
    const double distance = distance_to_bone(armature.bones[b], point);
    if (nearest >= 0 && distance >= least) continue;
    nearest = static_cast<int>(b);
    least = distance;
  }
  if (nearest != limb.root) return true;
  const Bone& root = armature.bones[nearest];
  const glm::dvec3 along = root.tail - root.head;
  return glm::dot(point - root.head, along) > limb.grown_together * glm::dot(along, along);
}

std::optional<LimbName> limb_named(std::string_view tissue_name) {
  std::string name(tissue_name);
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return c == '_' ? ' ' : static_cast<char>(std::tolower(c)); });
  const auto ends_with = [&](std::string_view ending) { return name.ends_with(ending); };
  // "arm", "head" and other singular words mean a limb only after a comma. Elsewhere they may mean the head of a muscle
  // or the neck of an organ.
  if (ends_with(" arms") || ends_with(", arm")) return LimbName::Arms;
  if (ends_with(" legs") || ends_with(", leg")) return LimbName::Legs;
  if (ends_with(", trunk") || ends_with(", torso")) return LimbName::Trunk;
  if (ends_with(", head") || ends_with(", neck") || ends_with(", head and neck")) return LimbName::Head;
  return std::nullopt;
}

}  // namespace limber
