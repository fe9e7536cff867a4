// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/clinical_angles.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/pose/finger_frames.h"
#include "core/pose/joint_turns.h"
#include "core/rig/joint_limits.h"

namespace limber {

namespace {

using enum BodyJoint;

// Largest rotation of a bone across its hinge axis, radians, for which the bone counts as rotated about this axis only.
constexpr double kAcrossHinge = 0.01 * std::numbers::pi / 180;

// Least pronation that is returned, degrees: the middle of the usual range (-10 to 175 degrees) minus half a turn.
constexpr double kLeastPronation = -97.5;

class Reading {
 public:
  Reading(const Armature& armature, const BodyFrames& frames, const Pose& pose)
      : armature_(armature),
        frames_(frames),
        pose_(pose) {
    for (const RigidTransform& transform : posed_from_rest(armature, pose)) turned_.push_back(transform.rotation);
  }

  JointMotions at(const SidedJoint& joint) const {
    const std::vector<int> bones = bones_turned_by(frames_, joint);
    if (joint.joint == Forearm) return forearm(joint);
    if (bones.empty()) return {};
    if (is_finger(joint.joint)) return finger(bones);
    const auto& hinge = frames_.frames[static_cast<std::size_t>(bones.front())].hinge;
    if (hinge && bones.size() == 1) {
      const SwingTwist parts = swing_twist(pose_.rotation[static_cast<std::size_t>(bones.front())], hinge->axis);
      if (glm::length(parts.swing) < kAcrossHinge) return {glm::degrees(hinge->at_rest + parts.twist)};
    }
    return joint_motions_of(joint.joint, turn(joint, bones.front(), bones.back()));
  }

 private:
  // Returns the rotation between the bone above `first` and the bone `last`, in the axes of a left joint.
  glm::dquat turn(const SidedJoint& joint, int first, int last) const {
    const int reference = reference_bone(armature_, frames_, first, joint.joint);
    const glm::dquat above = reference < 0 ? glm::dquat(1, 0, 0, 0) : from_anatomical(reference);
    const glm::dquat& axes = frames_.frames[static_cast<std::size_t>(last)].joint_axes;
    return turn_in_body(frames_, joint.side,
                        glm::conjugate(axes) * glm::conjugate(above) * from_anatomical(last) * axes);
  }

  glm::dquat from_anatomical(int bone) const {
    return turn_from_anatomical(frames_, bone, turned_[static_cast<std::size_t>(bone)]);
  }

  // Returns the pronation: the sum of the rotations of the forearm bone and the hand bone about their length.
  JointMotions forearm(const SidedJoint& joint) const {
    const auto hand = pronating_hand(frames_, joint.side);
    const std::vector<int> bones = bones_turned_by(frames_, joint);
    if (bones.empty() && !hand) return {};
    double pronation = 0;
    if (!bones.empty() && !frames_.frames[static_cast<std::size_t>(bones[0])].hinge)
      pronation -= pronation_in_forearm(turn({Elbow, joint.side}, bones[0], bones[0]));
    if (hand) pronation -= pronation_in_hand(turn({Wrist, joint.side}, *hand, *hand));
    const double degrees = std::remainder(glm::degrees(pronation), 360);
    return {degrees < kLeastPronation ? degrees + 360 : degrees};
  }

  JointMotions finger(const std::vector<int>& bones) const {
    JointMotions motions;
    for (const int bone : bones) {
      const auto& hinge = frames_.frames[static_cast<std::size_t>(bone)].hinge;
      if (!hinge) continue;
      const auto role =
          std::find_if(frames_.bone.begin(), frames_.bone.end(), [&](const auto& one) { return one.second == bone; });
      const std::size_t segment =
          role->first.part == BodyPart::Fingers ? 0 : static_cast<std::size_t>(role->first.index - 1);
      const FingerAngles angles = finger_angles(*hinge, pose_.rotation[static_cast<std::size_t>(bone)]);
      motions[segment] = glm::degrees(angles.flexion);
      if (hinge->spread_axis != glm::dvec3(0)) motions[kSpread] = glm::degrees(angles.spread);
    }
    return motions;
  }

  const Armature& armature_;
  const BodyFrames& frames_;
  const Pose& pose_;
  std::vector<glm::dquat> turned_;
};

// Returns the range of the rig's limits for the flexion of a hinge, degrees from the anatomical position.
AngleRange hinge_range(const JointLimits& limits, const AnatomicalHinge& hinge) {
  const bool same = glm::dot(limits.axis, hinge.axis) >= 0;
  return {glm::degrees(hinge.at_rest + (same ? limits.minimum : -limits.maximum)),
          glm::degrees(hinge.at_rest + (same ? limits.maximum : -limits.minimum))};
}

}  // namespace

std::vector<SidedJoint> joints_known_by_name(const BodyFrames& frames) {
  std::vector<SidedJoint> joints;
  for (const BodyJoint joint : kAllJoints)
    for (const BodySide side : {BodySide::Left, BodySide::Right, BodySide::Middle})
      if ((side == BodySide::Middle || is_paired(joint)) && has_joint(frames, {joint, side}))
        joints.push_back({joint, side});
  return joints;
}

JointAngles clinical_angles(const Armature& armature, const BodyFrames& frames, const Pose& pose) {
  const Reading reading(armature, frames, pose);
  JointAngles angles;
  for (const SidedJoint& joint : joints_known_by_name(frames)) angles[joint] = reading.at(joint);
  return angles;
}

JointMotions angles_of_joint(const Armature& armature, const BodyFrames& frames, const Pose& pose,
                             const SidedJoint& joint) {
  return Reading(armature, frames, pose).at(joint);
}

Pose with_clinical_angle(const Armature& armature, const BodyFrames& frames, const Pose& pose, const SidedJoint& joint,
                         std::size_t motion, double degrees) {
  const Reading reading(armature, frames, pose);
  const JointMotions before = reading.at(joint);
  JointMotions after = before;
  after[motion] = degrees;
  JointAngles angles{{joint, after}};
  const SidedJoint girdle{Girdle, joint.side};
  if (joint.joint == Shoulder && has_joint(frames, girdle)) {
    JointMotions blade = reading.at(girdle);
    const double rhythm = shoulder_rhythm(raise_of_arm(after)) - shoulder_rhythm(raise_of_arm(before));
    blade[2] = blade[2].value_or(0) + rhythm;
    angles[girdle] = blade;
  }
  return with_joint_angles(armature, frames, pose, angles);
}

HandShape hand_shape(const JointAngles& angles, BodySide side) {
  double curl = 0, spread = 0;
  int bends = 0, spreads = 0;
  for (const BodyJoint finger : {Index, Middle, Ring, Little}) {
    const auto found = angles.find({finger, side});
    if (found == angles.end()) continue;
    for (const std::size_t joint : {0, 1})
      if (found->second[joint]) curl += *found->second[joint], ++bends;
    if (finger != Middle && found->second[kSpread]) spread += *found->second[kSpread], ++spreads;
  }
  HandShape shape;
  if (bends) shape.curl = curl / bends;
  if (spreads) shape.spread = spread / spreads;
  return shape;
}

AngleRange range_of_motion(const Armature& armature, const BodyFrames& frames, const SidedJoint& joint,
                           std::size_t motion) {
  const AngleRange usual = usual_range(joint.joint, motion).value_or(AngleRange{-180, 180});
  if (joint.joint == Forearm || motion == kSpread) return usual;
  const std::vector<int> bones = bones_turned_by(frames, joint);
  for (const int bone : bones) {
    const JointLimits& limits = armature.bones[static_cast<std::size_t>(bone)].limits;
    const auto& hinge = frames.frames[static_cast<std::size_t>(bone)].hinge;
    if (!hinge || limits.type != JointLimits::Type::Hinge) continue;
    const bool moved = is_finger(joint.joint)
                           ? frames.find(part_of(joint.joint), joint.side, static_cast<int>(motion) + 1) == bone
                           : motion == 0;
    if (moved) return hinge_range(limits, *hinge);
  }
  return usual;
}

std::vector<SidedJoint> joints_of_bone(const BodyFrames& frames, int bone) {
  std::vector<SidedJoint> joints;
  for (const SidedJoint& joint : joints_known_by_name(frames)) {
    const std::vector<int> bones = bones_turned_by(frames, joint);
    const bool pronates = joint.joint == Forearm && pronating_hand(frames, joint.side) == bone;
    if (pronates || std::find(bones.begin(), bones.end(), bone) != bones.end()) joints.push_back(joint);
  }
  return joints;
}

}  // namespace limber
