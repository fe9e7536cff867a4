// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/retarget_confidence.h"

#include "core/rig/joint_names.h"

namespace limber {

namespace {

template <class Parts>
std::vector<std::optional<JointRole>> roles_of(const Parts& parts) {
  std::vector<std::string> names;
  std::vector<int> parents;
  for (const auto& part : parts) {
    names.push_back(part.name);
    parents.push_back(part.parent);
  }
  return joint_roles(names, parents);
}

}  // namespace

std::vector<MatchKind> match_kinds(const Motion& motion, const Armature& armature, const RetargetMap& map) {
  const auto bone_roles = roles_of(armature.bones), joint_roles = roles_of(motion.joints);
  std::map<std::string, std::size_t> joints;
  for (std::size_t j = 0; j < motion.joints.size(); ++j) joints.emplace(motion.joints[j].name, j);

  std::vector<MatchKind> kinds(armature.bones.size(), MatchKind::None);
  for (std::size_t b = 0; b < kinds.size(); ++b) {
    const std::string& name = armature.bones[b].name;
    const auto joint = joints.find(map.joint_of(name));
    if (joint == joints.end()) continue;
    const auto &bone = bone_roles[b], &source = joint_roles[joint->second];
    const bool same_part =
        bone && source && bone->part == source->part && (bone->side == source->side || bone->side == BodySide::Middle);
    if (plain_name(name) == plain_name(joint->first)) kinds[b] = MatchKind::SameName;
    else if (same_part && (bone->part == BodyPart::Spine || bone->part == BodyPart::Neck)) kinds[b] = MatchKind::Chain;
    else if (same_part && bone->index == source->index) kinds[b] = MatchKind::SamePart;
    else kinds[b] = MatchKind::ByHand;
  }
  return kinds;
}

double confidence(MatchKind kind) {
  switch (kind) {
    case MatchKind::None:
    case MatchKind::ByHand: break;
    case MatchKind::Chain: return 0.7;
    case MatchKind::SamePart: return 0.9;
    case MatchKind::SameName: return 1;
  }
  return 0;
}

}  // namespace limber
