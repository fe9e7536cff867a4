// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/anatomical_position.h"

#include <cmath>
#include <numbers>

namespace limber {

namespace {

// An angle about a hinge is read only if the unit direction of each bone has at least this component across the hinge's
// axis; a bone along the axis shows no angle.
constexpr double kTells = 0.3;
// Radians; toes, feet, necks and heads that are bent by at most this count as straight.
constexpr double kAskew = std::numbers::pi / 6;

glm::dvec3 direction(const Bone& bone) {
  const glm::dvec3 along = bone.tail - bone.head;
  const double length = glm::length(along);
  return length > 0 ? along / length : glm::dvec3(0);
}

// Returns true if a bone is in line with its parent in the anatomical position. For a bone whose name tells no body
// part this is assumed if its head is near its parent's tail.
bool straightens(const Armature& armature, int bone, const std::optional<JointRole>& role) {
  if (!role) {
    const Bone& b = armature.bones[bone];
    const Bone& parent = armature.bones[b.parent];
    return glm::distance(parent.tail, b.head) <= 0.05 * glm::distance(parent.head, parent.tail);
  }
  switch (role->part) {
    case BodyPart::Forearm:
    case BodyPart::Shank:
    case BodyPart::Hand:
    case BodyPart::Toes: return true;
    // Metacarpals are not in line with the hand: that of the thumb points to the side, and those of the fingers spread.
    case BodyPart::Thumb: return role->index > 1;
    case BodyPart::Index:
    case BodyPart::Middle:
    case BodyPart::Ring:
    case BodyPart::Little: return role->index > 0;
    default: return false;
  }
}

bool runs_askew(BodyPart part) {
  return part == BodyPart::Toes || part == BodyPart::Foot || part == BodyPart::Neck || part == BodyPart::Head;
}

// Returns the rotation vector of the shortest rotation from one unit direction to another. Returns zero for opposite
// directions, which have no unique shortest rotation.
glm::dvec3 shortest_turn(const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 axis = glm::cross(from, to);
  const double sine = glm::length(axis);
  return sine > 1e-9 ? axis * (std::atan2(sine, glm::dot(from, to)) / sine) : glm::dvec3(0);
}

// Returns the upward unit direction of the spine. Returns zero if the rig has no spine.
glm::dvec3 trunk(const Armature& armature) {
  const auto roles = roles_of(armature);
  glm::dvec3 up(0);
  for (std::size_t b = 0; b < roles.size(); ++b)
    if (roles[b] && roles[b]->part == BodyPart::Spine) up += armature.bones[b].tail - armature.bones[b].head;
  const double length = glm::length(up);
  return length > 0 ? up / length : glm::dvec3(0);
}

}  // namespace

std::vector<std::optional<JointRole>> roles_of(const Armature& armature) {
  std::vector<std::string> names;
  std::vector<int> parents;
  for (const Bone& bone : armature.bones) {
    names.push_back(bone.name);
    parents.push_back(bone.parent);
  }
  return joint_roles(names, parents);
}

std::optional<double> told_hinge_angle(const Armature& armature, int index, const glm::dvec3& axis) {
  const Bone& bone = armature.bones[index];
  if (bone.parent < 0) return std::nullopt;
  const auto role = roles_of(armature)[index];
  if (!straightens(armature, index, role)) return std::nullopt;
  const auto across = [&](const Bone& b) { return direction(b) - glm::dot(direction(b), axis) * axis; };
  const glm::dvec3 above = across(armature.bones[bone.parent]), below = across(bone);
  if (glm::length(above) < kTells || glm::length(below) < kTells) return std::nullopt;
  const double angle = std::atan2(glm::dot(glm::cross(above, below), axis), glm::dot(above, below));
  return role && runs_askew(role->part) && std::abs(angle) <= kAskew ? 0 : angle;
}

double hinge_angle_at_rest(const Armature& armature, int index, const glm::dvec3& axis) {
  return told_hinge_angle(armature, index, axis).value_or(0);
}

glm::dvec3 ball_swing_at_rest(const Armature& armature, int index, BodyPart part) {
  const Bone& bone = armature.bones[index];
  const glm::dvec3 along = direction(bone),
                   above = bone.parent < 0 ? glm::dvec3(0) : direction(armature.bones[bone.parent]);
  glm::dvec3 neutral(0);
  switch (part) {
    case BodyPart::UpperArm:
    case BodyPart::Thigh: neutral = -trunk(armature); break;
    case BodyPart::Hand:
    case BodyPart::Neck:
    case BodyPart::Head: neutral = above; break;
    case BodyPart::Foot: neutral = along - glm::dot(along, above) * above; break;
    default: break;
  }
  const double length = glm::length(neutral);
  if (length < kTells || (part == BodyPart::Foot && above == glm::dvec3(0))) return glm::dvec3(0);
  const glm::dvec3 turn = shortest_turn(neutral / length, along);
  return runs_askew(part) && glm::length(turn) <= kAskew ? glm::dvec3(0) : turn;
}

glm::dvec3 turn_at_rest(const Armature& armature, int index) {
  const JointLimits& limits = armature.bones[index].limits;
  if (limits.type == JointLimits::Type::Hinge) return limits.axis * hinge_angle_at_rest(armature, index, limits.axis);
  if (limits.type != JointLimits::Type::Ball) return glm::dvec3(0);
  const auto role = roles_of(armature)[index];
  return role ? ball_swing_at_rest(armature, index, role->part) : glm::dvec3(0);
}

}  // namespace limber
