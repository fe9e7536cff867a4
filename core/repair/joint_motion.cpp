// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/repair/joint_motion.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/base/error.h"
#include "core/pose/anatomical_frames.h"
#include "core/pose/anatomical_pose.h"
#include "core/rig/joint_ranges.h"

namespace limber {

namespace {

constexpr double kDegree = std::numbers::pi / 180;
// Largest angle between successive turns, degrees. Tissue volumes change smoothly from one turn to the next.
constexpr double kLargestStep = 22.5;
constexpr double kLeastTurn = 5;  // degrees; a smaller turn is left out, since it changes hardly any voxel
// Limits of the turns, degrees from rest: with a given range, without one, and for swings of ball joints.
constexpr double kWidestRange = 170, kWidestDefault = 120, kWidestSwing = 60;

// Returns the limits of the joint: those of the rig, else the usual limits for the bone's name.
JointLimits limits_of(const Armature& armature, int bone) {
  const JointLimits& own = armature.bones[bone].limits;
  if (own.type == JointLimits::Type::Hinge || own.type == JointLimits::Type::Ball) return own;
  const std::optional<int> joint = usual_joints_of(armature)[bone];
  return joint ? usual_limits(armature, bone, *joint) : JointLimits{};
}

std::vector<int> bones_below(const Armature& armature, int bone) {
  std::vector<std::uint8_t> is_below(armature.bones.size(), 0);
  std::vector<int> below;
  for (int b = bone; b < static_cast<int>(armature.bones.size()); ++b) {
    const int parent = armature.bones[b].parent;
    if (b != bone && (parent < 0 || !is_below[parent])) continue;
    is_below[b] = 1;
    below.push_back(b);
  }
  return below;
}

// Returns an axis, perpendicular to the bone, about which a ball joint swings. It is made from the axis of the body
// (left, back, up) that is least parallel to the bone. If the left axis and another axis are about equally unparallel
// to the bone, the left axis is used, so that a hanging leg swings forward and back.
glm::dvec3 swing_axis(const Armature& armature, int bone) {
  const glm::dvec3 whole = armature.bones[bone].tail - armature.bones[bone].head;
  if (!(glm::length(whole) > 0))
    throw Error("the bone has no length, so the axes of its joint are not known", armature.bones[bone].name,
                "give the bone a length, or its joint a hinge");
  const glm::dvec3 along = glm::normalize(whole);
  const glm::dmat3 body = upright_axes(armature);
  glm::dvec3 best(0);
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3 across = body[axis] - along * glm::dot(along, body[axis]);
    if (glm::length(across) > glm::length(best) + 0.1) best = across;
  }
  return glm::normalize(best);
}

void add_turns(const glm::dvec3& axis, double low, double high, std::vector<JointTurn>& turns) {
  for (const double end : {low, high}) {
    if (std::abs(end) < kLeastTurn) continue;
    const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(end) / kLargestStep - 1e-6)));
    for (int i = 1; i <= steps; ++i) turns.push_back({axis, end * kDegree * i / steps});
  }
}

void check_range(const TurnRange& range, const std::string& bone) {
  if (range.low < range.high && range.low <= 0 && range.high >= 0 && range.low >= -kWidestRange &&
      range.high <= kWidestRange && std::max(-range.low, range.high) >= kLeastTurn)
    return;
  char text[96];
  std::snprintf(text, sizeof text, "%g,%g degrees at the joint of ", range.low, range.high);
  throw Error(
      "a joint cannot be repaired over this range", text + bone,
      "write two angles from rest, such as 0,90: the first from -170 to 0, the second from 0 to 170, at least 5 "
      "degrees apart");
}

// The range over which hips and shoulders are repaired, in degrees from the anatomical position: as far as sitting,
// walking and reaching need. Adduction and rotation are not included.
struct BallTurns {
  BodyPart part;
  BodyJoint joint;
  std::vector<JointMotions> motions;
};
const std::vector<BallTurns>& ball_turns() {
  static const std::vector<BallTurns> turns = {
      {BodyPart::UpperArm,
       BodyJoint::Shoulder,
       {{45, 0, 0}, {90, 0, 0}, {-30, 0, 0}, {0, 0, 0}, {0, 30, 0}, {0, 60, 0}, {0, 90, 0}}},
      {BodyPart::Thigh,
       BodyJoint::Hip,
       {{30, 0, 0}, {60, 0, 0}, {90, 0, 0}, {-15, 0, 0}, {0, 0, 0}, {0, 20, 0}, {0, 40, 0}}},
  };
  return turns;
}

// Returns the turns of a hip or a shoulder; empty if the bone's name means neither.
std::vector<JointTurn> named_turns(const Armature& armature, int bone) {
  std::vector<JointTurn> turns;
  const BodyFrames frames = body_frames(armature);
  for (const auto& [role, named] : frames.bone)
    for (const BallTurns& ball : ball_turns()) {
      if (named != bone || role.part != ball.part) continue;
      for (const JointMotions& motions : ball.motions) {
        const Pose pose =
            with_joint_angles(armature, frames, rest_pose(armature), {{{ball.joint, role.side}, motions}});
        glm::dquat turn = pose.rotation[bone];
        if (turn.w < 0) turn = -turn;
        const double angle = glm::angle(turn);
        if (angle >= kLeastTurn * kDegree && angle <= kWidestDefault * kDegree)
          turns.push_back({glm::axis(turn), angle});
      }
    }
  return turns;
}

std::vector<JointTurn> own_turns(const Armature& armature, int bone) {
  const JointLimits limits = limits_of(armature, bone);
  std::vector<JointTurn> turns;
  if (limits.type == JointLimits::Type::Hinge)
    add_turns(limits.axis, std::clamp(limits.minimum / kDegree, -kWidestDefault, 0.0),
              std::clamp(limits.maximum / kDegree, 0.0, kWidestDefault), turns);
  if (limits.type == JointLimits::Type::Ball) turns = named_turns(armature, bone);
  if (limits.type == JointLimits::Type::Ball && turns.empty()) {
    const glm::dvec3 first = swing_axis(armature, bone),
                     second = glm::normalize(glm::cross(armature.bones[bone].tail - armature.bones[bone].head, first));
    const double most = std::min(limits.cone / kDegree, kWidestSwing);
    for (const glm::dvec3& axis : {first, second}) add_turns(axis, -most, most, turns);
  }
  const JointLimits::Type own = armature.bones[bone].limits.type;
  if (own == JointLimits::Type::Fixed || (turns.empty() && own != JointLimits::Type::Free))
    throw Error("the rig's limits do not let this joint turn by 5 degrees", armature.bones[bone].name,
                "widen the limits, or give a range, such as 0,90");
  if (turns.empty()) add_turns(flex_axis(armature, bone), 0, 90, turns);
  return turns;
}

}  // namespace

JointMotion joint_motion(const Armature& armature, int bone, const std::optional<TurnRange>& range) {
  const Bone& child = armature.bones[bone];
  if (child.parent < 0) throw Error("this bone has no joint to repair", child.name, "choose a bone that has a parent");
  JointMotion motion{.bone = bone, .centre = child.head, .turns = {}, .moving = bones_below(armature, bone)};
  if (!range) {
    motion.turns = own_turns(armature, bone);
    return motion;
  }
  check_range(*range, child.name);
  const JointLimits limits = limits_of(armature, bone);
  const bool is_hinge = limits.type == JointLimits::Type::Hinge;
  add_turns(is_hinge ? limits.axis : flex_axis(armature, bone), range->low, range->high, motion.turns);
  return motion;
}

Pose turned(const Armature& armature, const JointMotion& motion, const JointTurn& turn) {
  Pose pose = rest_pose(armature);
  pose.rotation[motion.bone] = glm::angleAxis(turn.angle, turn.axis);
  return pose;
}

}  // namespace limber
