// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/bone_reach.h"

#include <algorithm>

namespace limber {

namespace {
// The flesh beyond the tail of a chain's last bone (four fingers, the toes, the jaw) follows this bone too, and most of
// it is further from the bone than the bone is long. So the distance to a last bone is reduced: its part beyond
// kOwnReach times the bone's length is multiplied by kLastBone.
constexpr float kOwnReach = 0.5f;
constexpr float kLastBone = 0.65f;
// A bone that only links a limb to the trunk (a collarbone) should get less flesh, since the chest below it belongs to
// the trunk. So the distance to this bone is multiplied by kLink. A bone is a link if it is shorter than kLinkShare of
// its child's length, and if it turns away from the direction of a parent with several children.
constexpr float kLink = 1 / kLastBone;
constexpr double kLinkShare = 0.75;
// Flesh counts as being around a joint if the distance to its nearest bone is at least this share of its distance to
// the joint. Such flesh is about equally near to the joint's two bones, so the plane through the joint divides it
// (Hinges).
constexpr float kAtJoint = 0.75f;

glm::dvec3 along(const Bone& bone) { return bone.tail - bone.head; }

bool is_link(const Armature& armature, size_t b) {
  const Bone& bone = armature.bones[b];
  if (bone.parent < 0) return false;
  const double length = glm::length(along(bone));
  const glm::dvec3 before = along(armature.bones[bone.parent]);
  bool forks = false, leads_on = false;
  for (size_t other = 0; other < armature.bones.size(); ++other) {
    forks |= other != b && armature.bones[other].parent == bone.parent;
    leads_on |= armature.bones[other].parent == static_cast<int>(b) &&
                length < kLinkShare * glm::length(along(armature.bones[other]));
  }
  return forks && leads_on && glm::dot(along(bone), before) < 0.5 * length * glm::length(before);
}

// Returns for each bone whether it is the last bone of a chain: no other bone is its child.
std::vector<bool> are_last(const Armature& armature) {
  std::vector<bool> last(armature.bones.size(), true);
  for (const Bone& bone : armature.bones)
    if (bone.parent >= 0) last[bone.parent] = false;
  return last;
}
}  // namespace

std::vector<BoneReach> reaches_of_bones(const Armature& armature) {
  const std::vector<bool> last = are_last(armature);
  std::vector<BoneReach> reaches(armature.bones.size());
  for (size_t b = 0; b < reaches.size(); ++b) {
    if (last[b]) reaches[b] = {kOwnReach * static_cast<float>(glm::length(along(armature.bones[b]))), kLastBone};
    if (is_link(armature, b)) reaches[b] = {0, kLink};
  }
  return reaches;
}

Hinges::Hinges(const Armature& armature) : ends_(armature.bones.size()) {
  const std::vector<bool> last = are_last(armature);
  for (size_t b = 0; b < ends_.size(); ++b)
    for (int side = 0; side < 2 && !last[b]; ++side) ends_[b][side] = end_of(armature, b, side);
}

std::uint16_t Hinges::bone_at(const glm::vec3& point, std::uint16_t nearest, float distance) const {
  for (const End& end : ends_[nearest]) {
    if (end.other < 0) continue;
    const glm::vec3 from_joint = point - end.joint;
    if (glm::dot(from_joint, end.inward) < 0 && glm::dot(from_joint, end.parting) > 0 &&
        distance >= kAtJoint * glm::length(from_joint))
      return static_cast<std::uint16_t>(end.other);
  }
  return nearest;
}

Hinges::End Hinges::end_of(const Armature& armature, size_t b, int side) {
  auto joint = [](const Bone& bone, int at) { return at ? bone.tail : bone.head; };
  auto inward = [](const Bone& bone, int at) { return glm::normalize(at ? -along(bone) : along(bone)); };
  const Bone& bone = armature.bones[b];
  const double length = glm::length(along(bone));
  End end;
  int met = 0;
  for (size_t o = 0; o < armature.bones.size(); ++o)
    for (int at = 0; at < 2; ++at) {
      const Bone& other = armature.bones[o];
      const double near = 0.05 * std::min(length, glm::length(along(other)));
      if (o == b || !(near > 0) || glm::distance(joint(bone, side), joint(other, at)) > near) continue;
      ++met;
      end = {static_cast<int>(o), joint(bone, side), inward(bone, side), inward(other, at) - inward(bone, side)};
    }
  return met == 1 ? end : End();
}

}  // namespace limber
