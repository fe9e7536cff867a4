// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/joint_ranges.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "core/base/error.h"
#include "core/rig/anatomical_position.h"

namespace limber {

namespace {

// A joint's range of motion, degrees from the anatomical position. The range low .. high is that of a hinge's angle
// (positive in flexion) or a ball joint's twist. `cone` is the largest swing of a ball joint.
struct Range {
  const char* joint;
  BodyPart part;
  int index;  // number of the bone within its body part (JointRole::index); -1: any number
  bool hinge;
  double low, high;
  double cone;
  glm::dvec3 towards{0};  // direction in which flexion moves the bone of a hinge
};

// Largest overextension, radians, that a joint with flexion only may have at rest. A larger one shows that the hinge's
// axis has the wrong sign.
constexpr double kBentBack = 15 * 3.14159265358979 / 180;

constexpr glm::dvec3 kFront(0, -1, 0), kBack(0, 1, 0), kDown(0, 0, -1);

constexpr Range kRanges[] = {
    {"Neck", BodyPart::Neck, -1, false, -60, 60, 45},
    {"Head", BodyPart::Head, -1, false, -60, 60, 45},
    {"Spine", BodyPart::Spine, -1, false, -45, 45, 80},
    {"Shoulder", BodyPart::UpperArm, -1, false, -70, 90, 180},
    {"Elbow", BodyPart::Forearm, -1, true, 0, 150, 0, kFront},
    {"Wrist", BodyPart::Hand, -1, false, -80, 80, 80},
    {"Thumb, saddle joint", BodyPart::Thumb, 1, false, -10, 10, 70},
    {"Thumb, knuckle", BodyPart::Thumb, 2, true, 0, 50, 0, kFront},
    {"Thumb, last joint", BodyPart::Thumb, 3, true, 0, 80, 0, kFront},
    {"Finger, knuckle", BodyPart::Index, 1, true, -45, 90, 0, kFront},
    {"Finger, middle joint", BodyPart::Index, 2, true, 0, 100, 0, kFront},
    {"Finger, last joint", BodyPart::Index, 3, true, 0, 90, 0, kFront},
    {"Hip", BodyPart::Thigh, -1, false, -45, 45, 120},
    {"Knee", BodyPart::Shank, -1, true, 0, 135, 0, kBack},
    {"Ankle", BodyPart::Foot, -1, false, -35, 35, 50},
    {"Toes", BodyPart::Toes, -1, true, -70, 45, 0, kDown},
};

bool is_finger(BodyPart part) {
  return part == BodyPart::Index || part == BodyPart::Middle || part == BodyPart::Ring || part == BodyPart::Little;
}

std::optional<int> range_of(const JointRole& role) {
  const BodyPart part = is_finger(role.part) ? BodyPart::Index : role.part;
  for (std::size_t i = 0; i < std::size(kRanges); ++i)
    if (kRanges[i].part == part && (kRanges[i].index < 0 || kRanges[i].index == role.index)) return static_cast<int>(i);
  return std::nullopt;
}

// Returns the number of bones that together form the joint (the vertebrae of a spine, for example) and share its range.
int sharers(const Armature& armature, const Range& range) {
  const bool neck = range.part == BodyPart::Neck || range.part == BodyPart::Head;
  if (!neck && range.part != BodyPart::Spine) return 1;
  int count = 0;
  for (const auto& role : roles_of(armature))
    count +=
        role && (role->part == range.part || (neck && (role->part == BodyPart::Neck || role->part == BodyPart::Head)));
  return std::max(1, count);
}

// Returns true if a clavicle is among the bone's ancestors. When an arm is raised, the clavicle then contributes a
// third of the motion: for every two degrees at the shoulder joint, the shoulder blade turns by one.
bool has_collar_bone(const Armature& armature, int bone) {
  const auto roles = roles_of(armature);
  for (int above = armature.bones[bone].parent; above >= 0; above = armature.bones[above].parent)
    if (roles[above] && roles[above]->part == BodyPart::Clavicle) return true;
  return false;
}

glm::dvec3 hinge_axis(const Armature& armature, int index, const glm::dvec3& towards) {
  const Bone& bone = armature.bones[index];
  if (bone.limits.type == JointLimits::Type::Hinge) return bone.limits.axis;
  try {
    return flex_axis(armature, index);
  } catch (const Error&) {
    // flex_axis() finds no axis if the bone is in line with its parent or has no parent. The direction of flexion then
    // gives the axis.
    const glm::dvec3 axis = glm::cross(bone.tail - bone.head, towards);
    const double length = glm::length(axis), bone_length = glm::distance(bone.head, bone.tail);
    return length > 0.1 * bone_length ? axis / length : rest_axes(bone)[0];
  }
}

}  // namespace

std::vector<std::string> usual_joints() {
  std::vector<std::string> names;
  for (const Range& range : kRanges) names.push_back(range.joint);
  return names;
}

std::vector<std::optional<int>> usual_joints_of(const Armature& armature) {
  std::vector<std::optional<int>> joints;
  for (const auto& role : roles_of(armature)) joints.push_back(role ? range_of(*role) : std::nullopt);
  return joints;
}

JointLimits usual_limits(const Armature& armature, int bone, int joint) {
  const Range& range = kRanges[joint];
  JointLimits limits;
  if (range.hinge) {
    limits.type = JointLimits::Type::Hinge;
    limits.axis = hinge_axis(armature, bone, range.towards);
    double at_rest = hinge_angle_at_rest(armature, bone, limits.axis);
    if (range.low == 0 && at_rest < -kBentBack) limits.axis = -limits.axis, at_rest = -at_rest;
    limits.minimum = std::min(0.0, glm::radians(range.low) - at_rest);
    limits.maximum = std::max(0.0, glm::radians(range.high) - at_rest);
    return limits;
  }
  const double share = 1.0 / sharers(armature, range);
  limits.type = JointLimits::Type::Ball;
  const double widest = glm::radians(
      range.cone * (range.part == BodyPart::UpperArm && has_collar_bone(armature, bone) ? 2.0 / 3 : share));
  const double at_rest = glm::length(ball_swing_at_rest(armature, bone, range.part));
  limits.cone = std::max(widest - at_rest, at_rest);
  limits.twist_minimum = glm::radians(range.low * share);
  limits.twist_maximum = glm::radians(range.high * share);
  return limits;
}

std::string limits_text(const Armature& armature, int bone) {
  const JointLimits& limits = armature.bones[bone].limits;
  const double at_rest = limits.type == JointLimits::Type::Hinge ? hinge_angle_at_rest(armature, bone, limits.axis) : 0;
  char text[96];
  switch (limits.type) {
    case JointLimits::Type::Free: return "free";
    case JointLimits::Type::Fixed: return "fixed";
    case JointLimits::Type::Hinge:
      std::snprintf(text, sizeof text, "hinge, %ld to %ld degrees", std::lround(glm::degrees(limits.minimum + at_rest)),
                    std::lround(glm::degrees(limits.maximum + at_rest)));
      break;
    case JointLimits::Type::Ball:
      std::snprintf(text, sizeof text, "ball, cone of %.0f, twist %.0f to %.0f degrees", glm::degrees(limits.cone),
                    glm::degrees(limits.twist_minimum), glm::degrees(limits.twist_maximum));
      break;
  }
  return text;
}

}  // namespace limber
