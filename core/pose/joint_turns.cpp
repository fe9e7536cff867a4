// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/joint_turns.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/rig/joint_limits.h"

namespace limber {

namespace {

using enum BodyJoint;

const glm::dquat kNoTurn(1, 0, 0, 0);
const glm::dvec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);  // the body's left, back and up
// Unit normal of the left shoulder blade, which is at 35 degrees to the frontal plane. A blade that rotates about this
// axis stays on the ribs [Kapandji, The Physiology of the Joints].
const glm::dvec3 kOffBlade(0.573576436351046, 0.819152044288992, 0);

// Cosine of the second rotation below which a rotation counts as being in gimbal lock. At 1e-7, rounding errors of a
// quaternion already turn the first and the third angle by 1e-9 rad.
constexpr double kLocked = 1e-7;
constexpr double kNearLock = 0.05;  // degrees; within this distance of a gimbal lock the user is warned

glm::dquat about(const glm::dvec3& axis, double angle) { return glm::angleAxis(angle, axis); }

double radians_of(const JointMotions& motions, std::size_t motion) {
  return motions[motion].value_or(0) * std::numbers::pi / 180;
}

// Returns by how many degrees an angle is outside of a range; 0 if it is inside.
double excess(double angle, const AngleRange& range) { return std::max({range.low - angle, angle - range.high, 0.0}); }

// The signs of a joint's clinical angles in the Cardan rotations X, Y and Z, and the number of angles that the joint
// has.
struct CardanSigns {
  double x = 1, y = 1, z = 1;
  std::size_t motions = 3;
};

CardanSigns signs_of(BodyJoint joint) {
  switch (joint) {
    case Spine:
    case Neck: return {1, -1, 1};
    case Knee: return {1, 1, -1};
    case Ankle: return {-1, 1, -1};
    case Elbow: return {-1, -1, 1, 2};
    case Toes: return {-1, 1, 1, 1};
    default: return {-1, -1, -1};
  }
}

// Returns the angle, or the angle plus or minus 360 degrees if this is nearer to the joint's usual range.
double unwrapped(double angle, const AngleRange& range) {
  for (const double other : {angle - 360, angle + 360})
    if (excess(other, range) < excess(angle, range) - 1e-9) angle = other;
  return angle;
}

struct Candidate {
  JointMotions motions;
  double excess = 0;
};

// Converts Cardan angles (radians) to the clinical angles of a joint (degrees).
Candidate candidate_of(BodyJoint joint, const glm::dvec3& xyz) {
  const CardanSigns signs = signs_of(joint);
  const glm::dvec3 degrees = glm::degrees(xyz) * glm::dvec3(signs.x, signs.y, signs.z);
  Candidate candidate;
  for (std::size_t i = 0; i < signs.motions; ++i) {
    const AngleRange range = usual_range(joint, i).value_or(AngleRange{-180, 180});
    const double angle = unwrapped(std::remainder(degrees[static_cast<int>(i)], 360), range);
    candidate.motions[i] = angle;
    candidate.excess += excess(angle, range);
  }
  return candidate;
}

JointMotions cardan_motions(BodyJoint joint, const glm::dquat& turn) {
  constexpr double kPi = std::numbers::pi;
  const glm::dvec3 xyz = cardan_xyz(turn);
  const Candidate one = candidate_of(joint, xyz), other = candidate_of(joint, {xyz.x + kPi, kPi - xyz.y, xyz.z + kPi});
  // At a gimbal lock both candidates stand for the same rotation. The first one is used, since its first angle is zero.
  const bool locked = std::abs(std::cos(xyz.y)) < kLocked;
  return locked || one.excess <= other.excess + 1e-9 ? one.motions : other.motions;
}

JointMotions girdle_motions(const glm::dquat& turn) {
  const glm::dvec3 normal = turn * kOffBlade;
  const double sine = std::clamp(normal.z / kOffBlade.x, -1.0, 1.0), elevation = std::asin(sine);
  const double protraction =
      std::atan2(kOffBlade.y, kOffBlade.x * std::cos(elevation)) - std::atan2(normal.y, normal.x);
  const glm::dquat rest = about(kY, elevation) * about(kZ, protraction) * turn;
  return {glm::degrees(elevation), std::remainder(glm::degrees(protraction), 360),
          -glm::degrees(swing_twist(rest, kOffBlade).twist)};
}

bool mirrored(const BodyFrames& frames, BodySide side) {
  const auto found = frames.is_right.find(side);
  return found != frames.is_right.end() && found->second;
}

}  // namespace

glm::dquat joint_turn(BodyJoint joint, const JointMotions& motions) {
  const double a = radians_of(motions, 0), b = radians_of(motions, 1), c = radians_of(motions, 2);
  switch (joint) {
    case Spine:
    case Neck: return about(kX, a) * about(kY, -b) * about(kZ, c);
    case Girdle: return about(kZ, -b) * about(kY, -a) * about(kOffBlade, -c);
    case Shoulder:
    case Hip: return about(kX, -a) * about(kY, -b) * about(kZ, -c);
    case Elbow: return about(kX, -a) * about(kY, -b);
    case Toes: return about(kX, -a);
    case Wrist: return about(kX, -a) * about(kY, b);
    case Ankle: return about(kX, -a) * about(kY, b) * about(kZ, -c);
    case Knee: return about(kX, a) * about(kY, b) * about(kZ, -c);
    default: return kNoTurn;
  }
}

JointMotions joint_motions_of(BodyJoint joint, const glm::dquat& turn) {
  if (joint == Forearm || is_finger(joint)) return {};
  if (joint == Girdle) return girdle_motions(turn);
  if (joint != Wrist) return cardan_motions(joint, turn);
  const glm::dmat3 m = glm::mat3_cast(turn);
  return {-glm::degrees(std::atan2(m[1].z, std::hypot(m[0].z, m[2].z))), glm::degrees(std::atan2(-m[0].z, m[2].z))};
}

double pronation_in_forearm(const glm::dquat& turn) {
  const glm::dmat3 m = glm::mat3_cast(turn);
  return std::atan2(-m[1].x, m[0].x);
}

double pronation_in_hand(const glm::dquat& turn) {
  const glm::dmat3 m = glm::mat3_cast(turn);
  return std::atan2(-m[1].x, m[1].y);
}

glm::dvec3 cardan_xyz(const glm::dquat& rotation) {
  const glm::dmat3 m = glm::mat3_cast(rotation);
  const double cosine = std::hypot(m[0].x, m[1].x), y = std::atan2(m[2].x, cosine);
  if (cosine < kLocked) return {0, y, std::atan2(m[0].y, m[1].y)};
  return {std::atan2(-m[2].y, m[2].z), y, std::atan2(-m[1].x, m[0].x)};
}

bool at_gimbal_lock(BodyJoint joint, const JointMotions& motions) {
  if (joint == Forearm || is_finger(joint)) return false;
  const std::optional<double>& second = motions[joint == Wrist || joint == Girdle ? 0 : 1];
  return second && std::abs(std::abs(std::remainder(*second, 180)) - 90) < kNearLock;
}

double raise_of_arm(const JointMotions& shoulder) {
  const glm::dvec3 arm = joint_turn(Shoulder, shoulder) * -kZ;
  return glm::degrees(std::acos(std::clamp(-arm.z, -1.0, 1.0)));
}

// When an arm is raised by more than 30 degrees, the shoulder blade contributes a third of the further motion. Half of
// this third happens at the collarbone's inner end, the other half between collarbone and blade. Only the first half, a
// sixth of the motion, is added here: rigs move the blade together with the collarbone, and with more rotation the
// blade would leave the ribs.
double shoulder_rhythm(double raise) {
  constexpr double kSetting = 30, kShare = 1.0 / 6;
  return kShare * std::max(0.0, raise - kSetting);
}

std::vector<int> bones_turned_by(const BodyFrames& frames, const SidedJoint& joint) {
  std::vector<int> bones;
  const auto add = [&](BodyPart part, int index) {
    if (const auto bone = frames.find(part, joint.side, index); bone && *bone != frames.only_root)
      bones.push_back(*bone);
  };
  const BodyPart part = part_of(joint.joint);
  if (joint.joint == Spine || joint.joint == Neck) {
    for (int index = 0; frames.find(part, BodySide::Middle, index); ++index) add(part, index);
    if (joint.joint == Neck) add(BodyPart::Head, 0);
  } else if (is_finger(joint.joint)) {
    for (int segment = 1; segment <= 3; ++segment) add(part, segment);
    // A bone that stands for all fingers together bends by the angles of the middle finger.
    if (bones.empty() && joint.joint == Middle) add(BodyPart::Fingers, 0);
  } else {
    add(part, 0);
  }
  return bones;
}

std::optional<int> pronating_hand(const BodyFrames& frames, BodySide side) {
  const auto hand = frames.find(BodyPart::Hand, side);
  return hand && *hand != frames.only_root ? hand : std::nullopt;
}

bool has_joint(const BodyFrames& frames, const SidedJoint& joint) {
  if (joint.joint == Forearm && pronating_hand(frames, joint.side)) return true;
  return !bones_turned_by(frames, joint).empty();
}

int reference_bone(const Armature& armature, const BodyFrames& frames, int bone, BodyJoint joint) {
  int above = armature.bones[static_cast<std::size_t>(bone)].parent;
  if (joint != Shoulder) return above;
  for (int b = above; b >= 0; b = armature.bones[static_cast<std::size_t>(b)].parent)
    for (const auto& [role, named] : frames.bone)
      if (named == b && role.part == BodyPart::Clavicle) above = armature.bones[static_cast<std::size_t>(b)].parent;
  return above;
}

glm::dquat turn_from_anatomical(const BodyFrames& frames, int bone, const glm::dquat& turn_from_rest) {
  if (bone < 0) return kNoTurn;
  return turn_from_rest * glm::conjugate(frames.frames[static_cast<std::size_t>(bone)].anatomical_from_rest);
}

glm::dquat turn_in_world(const BodyFrames& frames, BodySide side, const glm::dquat& turn) {
  const glm::dquat own = mirrored(frames, side) ? glm::dquat(turn.w, turn.x, -turn.y, -turn.z) : turn,
                   axes = glm::quat_cast(frames.body);
  return axes * own * glm::conjugate(axes);
}

glm::dquat turn_in_body(const BodyFrames& frames, BodySide side, const glm::dquat& turn) {
  const glm::dquat axes = glm::quat_cast(frames.body), q = glm::conjugate(axes) * turn * axes;
  return mirrored(frames, side) ? glm::dquat(q.w, q.x, -q.y, -q.z) : q;
}

}  // namespace limber
