// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/rest_pose_kind.h"

#include <cctype>
#include <numbers>

#include "core/base/error.h"

namespace limber {

namespace {

// Angle between a limb and its direction in the named rest pose up to which the limb is left as it is: 30 degrees. This
// tells the poses apart, since their arms differ by 45 degrees or more.
constexpr double kNear = std::numbers::pi / 6;
// Slope from the ankle down to the toes of a foot that stands flat, radians.
constexpr double kSole = 0.4;

bool is_finger(BodyPart part) {
  return part == BodyPart::Index || part == BodyPart::Middle || part == BodyPart::Ring || part == BodyPart::Little;
}

glm::dvec3 arm_in(RestStance stance, BodySide side) {
  const double out = side == BodySide::Left ? 1 : -1;
  if (stance == RestStance::TPose) return {out, 0, 0};
  if (stance == RestStance::APose) return glm::normalize(glm::dvec3(out, 0, -1));
  return {0, 0, -1};
}

}  // namespace

const char* word_of(RestStance stance) {
  constexpr const char* kWords[] = {"file", "T", "A", "anatomical"};
  return kWords[static_cast<int>(stance)];
}

RestStance stance_of_word(const std::string& word, const std::string& where) {
  const auto same = [&](const std::string& other) {
    return std::equal(word.begin(), word.end(), other.begin(), other.end(),
                      [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); });
  };
  for (const RestStance stance : kRestStances)
    if (same(word_of(stance))) return stance;
  if (same("supine")) return RestStance::Anatomical;
  throw Error("\"" + word.substr(0, 60) + "\" is not a rest pose", where,
              "write T, A, anatomical, or file (the pose that the file stores)");
}

std::optional<glm::dvec3> direction_in(RestStance stance, const JointRole& role) {
  if (stance == RestStance::AsItLies) return std::nullopt;
  switch (role.part) {
    case BodyPart::Spine:
    case BodyPart::Neck:
    case BodyPart::Head: return kUp;
    case BodyPart::Thigh:
    case BodyPart::Shank: return -kUp;
    case BodyPart::Foot: return glm::dvec3(0, -std::cos(kSole), -std::sin(kSole));
    case BodyPart::UpperArm:
    case BodyPart::Forearm:
    case BodyPart::Hand: break;
    default:
      if (!is_finger(role.part) || role.index == 0) return std::nullopt;
  }
  return role.side == BodySide::Middle ? std::nullopt : std::optional(arm_in(stance, role.side));
}

std::optional<glm::dvec3> palm_in(RestStance stance, BodySide side, const glm::dvec3& hand) {
  if (stance == RestStance::AsItLies || side == BodySide::Middle || glm::length(hand) < 1e-9) return std::nullopt;
  const glm::dvec3 inward(side == BodySide::Left ? -1 : 1, 0, 0), back(0, 1, 0);
  return shortest_turn(arm_in(stance, side), hand) * (stance == RestStance::Anatomical ? inward : back);
}

glm::dmat3 axes_of_body(const Skeleton& skeleton) {
  const auto hips = body_axes(skeleton, BodyPart::Thigh);
  return hips ? *hips : body_axes(skeleton, BodyPart::UpperArm).value_or(glm::dmat3(1));
}

Straightened straightened(const Motion& motion, RestStance stance, int frame) {
  Straightened result{motion, {}};
  Skeleton skeleton = skeleton_of(motion);
  place_joints(skeleton, motion, frame);
  const glm::dmat3 body = axes_of_body(skeleton);
  const auto world = forward_kinematics(motion, frame);
  // The rotation that turns each joint's limb into the stance, in the file's axes.
  std::vector<glm::dquat> turn(motion.joints.size(), glm::dquat(1, 0, 0, 0));
  for (int j = 0; j < std::ssize(turn); ++j) {
    BvhJoint& joint = result.motion.joints[j];
    const auto turned = [&](int by, const glm::dvec3& offset) {
      const glm::dquat& frame_turn = world[by].rotation;
      return glm::conjugate(frame_turn) * (turn[by] * (frame_turn * offset));
    };
    if (joint.parent >= 0) {
      joint.offset = turned(joint.parent, joint.offset);
      turn[j] = turn[joint.parent];
    }
    const glm::dvec3 here = direction_of(skeleton, j);
    const auto named = skeleton.role[j] ? direction_in(stance, *skeleton.role[j]) : std::nullopt;
    if (named && glm::length(here) > 1e-9) {
      const glm::dvec3 there = body * *named;
      // Feet have twice the tolerance: the slope of a foot depends on the height of the ankle above the sole, which
      // differs between skeletons.
      const bool near = angle_between(here, there) < (skeleton.role[j]->part == BodyPart::Foot ? 2 * kNear : kNear);
      turn[j] = near ? glm::dquat(1, 0, 0, 0) : shortest_turn(bvh_from_lps(here), bvh_from_lps(there));
      if (!near) result.turned.push_back(j);
    }
    if (joint.end_site) joint.end_site = turned(j, *joint.end_site);
  }
  return result;
}

}  // namespace limber
