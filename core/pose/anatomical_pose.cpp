// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/anatomical_pose.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/base/error.h"
#include "core/pose/finger_frames.h"
#include "core/pose/joint_turns.h"
#include "core/rig/joint_limits.h"

namespace limber {

namespace {

using enum BodyJoint;

const glm::dquat kNoTurn(1, 0, 0, 0);
const glm::dvec3 kZ(0, 0, 1);  // upwards in the body's axes

glm::dquat about(const glm::dvec3& axis, double angle) { return glm::angleAxis(angle, axis); }

// Returns the angle of a joint's motion (such as flexion) in radians, zero if it is not given.
double radians_of(const JointMotions& motions, std::size_t motion) {
  return motions[motion].value_or(0) * std::numbers::pi / 180;
}

// Adds the shoulder rhythm, the turn of a collarbone with a raised arm, where no angles of the collarbone are
// requested.
JointAngles with_shoulder_rhythm(const BodyFrames& frames, JointAngles angles) {
  for (const BodySide side : {BodySide::Left, BodySide::Right}) {
    const auto shoulder = angles.find({Shoulder, side});
    const double upward = shoulder == angles.end() ? 0 : shoulder_rhythm(raise_of_arm(shoulder->second));
    if (upward > 0 && frames.find(BodyPart::Clavicle, side))
      angles.try_emplace({Girdle, side}, JointMotions{0.0, 0.0, upward});
  }
  return angles;
}

bool has_on_a_side(const BodyFrames& frames, BodyJoint joint) {
  return has_joint(frames, {joint, BodySide::Left}) || has_joint(frames, {joint, BodySide::Right});
}

// Adds the side to a joint without one, if the rig has the joint on one side only. Throws Error if the rig does not
// have the joint, or has it on both sides.
SidedJoint sided(const BodyFrames& frames, const SidedJoint& joint, const std::string& where) {
  if (has_joint(frames, joint)) return joint;
  const std::string known = joints_of_rig(frames);
  if (known.empty())
    throw Error("no bone name of the rig is recognised", where,
                "name its bones as in \"LeftThigh\", or give the pose by --pose FILE");
  if (is_paired(joint.joint) && joint.side == BodySide::Middle) {
    const SidedJoint left{joint.joint, BodySide::Left}, right{joint.joint, BodySide::Right};
    if (has_joint(frames, left) && has_joint(frames, right))
      throw Error("the rig has a left and a right \"" + name_of(joint) + "\"", where,
                  "write left, right or both before the joint's name");
    if (has_joint(frames, left)) return left;
    if (has_joint(frames, right)) return right;
  }
  throw Error("the rig has no " + name_of(joint) + " between bones that are known by their names", where,
              "use one of these joints: " + known);
}

// Computes the rotations of all bones in world axes. Each rotation is computed when it is first needed, since bones may
// depend on bones that come later.
class Posing {
 public:
  Posing(const Armature& armature, const BodyFrames& frames, const Pose& base, const JointAngles& angles)
      : armature_(armature),
        frames_(frames),
        base_(base),
        turned_(armature.bones.size()),
        changed_(armature.bones.size(), false) {
    for (const RigidTransform& transform : posed_from_rest(armature, base)) base_turned_.push_back(transform.rotation);
    wanted_.resize(armature.bones.size());
    for (const auto& [joint, motions] : with_shoulder_rhythm(frames, angles)) want(joint, motions);
    follow_hands();
  }

  Pose pose() {
    Pose result = base_;
    for (std::size_t b = 0; b < armature_.bones.size(); ++b) {
      const int bone = static_cast<int>(b);
      turned(bone);
      if (changed_[b]) result.rotation[b] = glm::normalize(glm::conjugate(turned_parent(bone)) * turned(bone));
    }
    return result;
  }

 private:
  // The requested joint angles that move one bone.
  struct Wanted {
    std::vector<std::pair<SidedJoint, JointMotions>> joints;
    double share = 1;        // share of the rotation of spine or neck by which this bone rotates
    std::size_t motion = 0;  // index of a finger bone's angle in JointMotions
  };

  void want(const SidedJoint& joint, const JointMotions& motions) {
    const std::vector<int> bones = bones_turned_by(frames_, joint);
    for (std::size_t i = 0; i < bones.size(); ++i) {
      Wanted& wanted = wanted_[static_cast<std::size_t>(bones[i])];
      wanted.joints.emplace_back(joint, motions);
      wanted.share = 1.0 / static_cast<double>(bones.size());
      const auto role = std::find_if(frames_.bone.begin(), frames_.bone.end(),
                                     [&](const auto& one) { return one.second == bones[i]; });
      if (is_finger(joint.joint))
        wanted.motion = role->first.part == BodyPart::Fingers ? 0 : static_cast<std::size_t>(role->first.index - 1);
    }
    // The hand takes the share of the pronation that the forearm does not take.
    const auto hand = joint.joint == Forearm ? pronating_hand(frames_, joint.side) : std::nullopt;
    if (hand) wanted_[static_cast<std::size_t>(*hand)].joints.emplace_back(joint, motions);
  }

  // Makes finger bones follow the hand in rigs in which their parent is the forearm.
  void follow_hands() {
    followed_.assign(armature_.bones.size(), -1);
    for (const auto& [role, bone] : frames_.bone) {
      const auto hand = frames_.find(BodyPart::Hand, role.side), forearm = frames_.find(BodyPart::Forearm, role.side);
      const bool of_hand =
          role.part == BodyPart::Palm || role.part == BodyPart::Fingers || role.part >= BodyPart::Thumb;
      if (of_hand && hand && forearm && armature_.bones[static_cast<std::size_t>(bone)].parent == *forearm)
        followed_[static_cast<std::size_t>(bone)] = *hand;
    }
  }

  glm::dquat turned_parent(int bone) {
    const int parent = armature_.bones[static_cast<std::size_t>(bone)].parent;
    return parent < 0 ? kNoTurn : turned(parent);
  }

  const glm::dquat& turned(int bone) {
    auto& known = turned_[static_cast<std::size_t>(bone)];
    if (!known) known = find_turned(bone);
    return *known;
  }

  glm::dquat find_turned(int bone) {
    const auto b = static_cast<std::size_t>(bone);
    const int hand = followed_[b];
    glm::dquat now = turned_parent(bone) * base_.rotation[b];
    if (hand >= 0 && (turned(hand), changed_[static_cast<std::size_t>(hand)])) {
      now = turned(hand) * glm::conjugate(base_turned_[static_cast<std::size_t>(hand)]) * base_turned_[b];
      changed_[b] = true;
    }
    const Wanted& wanted = wanted_[b];
    if (!wanted.joints.empty()) changed_[b] = true;
    for (const auto& [joint, motions] : wanted.joints) now = with_joint(bone, now, joint, motions, wanted);
    return glm::normalize(now);
  }

  glm::dquat with_joint(int bone, const glm::dquat& now, const SidedJoint& joint, const JointMotions& motions,
                        const Wanted& wanted) {
    const BoneFrame& frame = frames_.frames[static_cast<std::size_t>(bone)];
    const bool across = motions[1].value_or(0) != 0 || motions[2].value_or(0) != 0;
    if (is_finger(joint.joint)) return frame.hinge ? finger_turn(bone, now, motions, wanted.motion, *frame.hinge) : now;
    if (frame.hinge && joint.joint != Forearm && !across)
      return hinged(bone, now, radians_of(motions, 0), *frame.hinge);

    const int reference = reference_bone(armature_, frames_, bone, joint.joint);
    const glm::dquat above = reference < 0 ? kNoTurn : turn_from_anatomical(frames_, reference, turned(reference));
    const glm::dquat before = glm::conjugate(above) * turn_from_anatomical(frames_, bone, now);
    glm::dquat turn = joint_turn(joint.joint, motions);
    if (joint.joint == Spine || joint.joint == Neck) turn = exponential(wanted.share * rotation_vector(turn));
    if (joint.joint == Elbow || joint.joint == Forearm || joint.joint == Wrist)
      turn = arm_turn(bone, turn_in_body(frames_, joint.side, before), joint, motions);
    const glm::dquat world =
        frame.joint_axes * turn_in_world(frames_, joint.side, turn) * glm::conjugate(frame.joint_axes);
    return above * world * frame.anatomical_from_rest;
  }

  // Returns a bone's world rotation with a flexion of its hinge, radians, in place of the joint's rotation.
  //   now  the bone's world rotation if the joint keeps its rotation
  glm::dquat hinged(int bone, const glm::dquat& now, double flexion, const AnatomicalHinge& hinge) const {
    return now * glm::conjugate(base_.rotation[static_cast<std::size_t>(bone)]) *
           about(hinge.axis, flexion - hinge.at_rest);
  }

  // Returns the world rotation of a finger's bone. An angle that is not requested keeps its value.
  //   now      the bone's world rotation if the joint keeps its rotation
  //   segment  index of the bone's flexion in JointMotions
  glm::dquat finger_turn(int bone, const glm::dquat& now, const JointMotions& motions, std::size_t segment,
                         const AnatomicalHinge& hinge) const {
    const glm::dquat& base = base_.rotation[static_cast<std::size_t>(bone)];
    const bool spreads = segment == 0 && hinge.spread_axis != glm::dvec3(0);
    if (!motions[segment] && !(spreads && motions[kSpread])) return now;
    FingerAngles angles = finger_angles(hinge, base);
    if (motions[segment]) angles.flexion = radians_of(motions, segment);
    if (spreads && motions[kSpread]) angles.spread = radians_of(motions, kSpread);
    return now * glm::conjugate(base) * rotation_of_finger(hinge, angles);
  }

  static glm::dvec3 rotation_vector(const glm::dquat& q) {
    const glm::dvec3 v(q.x, q.y, q.z);
    const double sine = glm::length(v);
    return sine > 0 ? v * (2 * std::atan2(sine, q.w) / sine) : glm::dvec3(0);
  }

  // Elbow and pronation both move the forearm bone; wrist and pronation both move the hand bone. This function replaces
  // the rotation of `joint` in the bone's rotation `before`, and keeps the rotation of the other joint.
  glm::dquat arm_turn(int bone, const glm::dquat& before, const SidedJoint& joint, const JointMotions& motions) const {
    const auto found = frames_.pronation.find(joint.side);
    const BodyFrames::Pronation pronation = found == frames_.pronation.end() ? BodyFrames::Pronation{} : found->second;
    const bool is_hand = frames_.find(BodyPart::Hand, joint.side) == bone;
    const double share = is_hand ? 1 - pronation.forearm_share : pronation.forearm_share;
    if (joint.joint == Forearm && share == 0) return before;
    // The pronation is a rotation about the limb's length: the leftmost factor of a hand's rotation, the rightmost
    // factor of a forearm's rotation.
    const glm::dquat kept = about(kZ, is_hand ? pronation_in_hand(before) : pronation_in_forearm(before));
    if (joint.joint == Elbow) return joint_turn(Elbow, motions) * kept;
    if (joint.joint == Wrist) return kept * joint_turn(Wrist, motions);
    const glm::dquat pronated = about(kZ, -share * radians_of(motions, 0));
    return is_hand ? pronated * glm::conjugate(kept) * before : before * glm::conjugate(kept) * pronated;
  }

  const Armature& armature_;
  const BodyFrames& frames_;
  const Pose& base_;
  std::vector<std::optional<glm::dquat>> turned_;
  std::vector<char> changed_;
  std::vector<glm::dquat> base_turned_;
  std::vector<Wanted> wanted_;
  std::vector<int> followed_;
};

}  // namespace

Pose with_joint_angles(const Armature& armature, const BodyFrames& frames, const Pose& pose,
                       const JointAngles& angles) {
  return angles.empty() ? pose : Posing(armature, frames, pose, angles).pose();
}

JointAngles with_sides(const BodyFrames& frames, const JointAngles& angles, const std::string& where) {
  // A request for both sides or for a whole hand stands for several joints. Those that the rig does not have are left
  // out.
  JointAngles found;
  for (const auto& [joint, motions] : angles)
    if (has_joint(frames, joint) || (joint.side == BodySide::Middle && has_on_a_side(frames, joint.joint)))
      found[sided(frames, joint, where)] = motions;
  if (!found.empty() || angles.empty()) return found;
  // A limb whose bone names tell no side takes angles that are requested for the left or the right side.
  for (const auto& [joint, motions] : angles)
    if (has_joint(frames, {joint.joint, BodySide::Middle})) found[{joint.joint, BodySide::Middle}] = motions;
  if (found.empty()) sided(frames, angles.begin()->first, where);
  return found;
}

JointAngles known_to_rig(const BodyFrames& frames, const JointAngles& angles) {
  JointAngles known;
  for (const auto& [joint, motions] : angles) {
    if (has_joint(frames, joint)) known[joint] = motions;
    // A limb whose bone names tell no side takes the angles of the left or the right side, as its shape tells.
    const bool right = joint.side == BodySide::Right;
    const SidedJoint sideless{joint.joint, BodySide::Middle};
    const auto shape = frames.is_right.find(BodySide::Middle);
    if (is_paired(joint.joint) && joint.side != BodySide::Middle && has_joint(frames, sideless) &&
        shape != frames.is_right.end() && shape->second == right)
      known[sideless] = motions;
  }
  return known;
}

std::string lacking_within_limbs(const BodyFrames& frames, const JointAngles& angles) {
  constexpr std::pair<BodyJoint, BodyJoint> kNextBelow[] = {
      {Shoulder, Elbow}, {Elbow, Wrist}, {Hip, Knee}, {Knee, Ankle}};
  std::string names;
  for (const auto& [joint, motions] : angles)
    for (const auto& [above, below] : kNextBelow) {
      const bool lacking =
          joint.joint == above && !frames.find(part_of(above), joint.side) && has_joint(frames, {below, joint.side});
      if (lacking) names += (names.empty() ? "" : ", ") + name_of(joint);
    }
  return names;
}

std::string limbs_apart(const Armature& armature, const BodyFrames& frames) {
  constexpr std::pair<BodyPart, BodyPart> kNextBelow[] = {{BodyPart::UpperArm, BodyPart::Forearm},
                                                          {BodyPart::Forearm, BodyPart::Hand},
                                                          {BodyPart::Thigh, BodyPart::Shank},
                                                          {BodyPart::Shank, BodyPart::Foot}};
  std::string names;
  for (const BodySide side : {BodySide::Middle, BodySide::Left, BodySide::Right})
    for (const auto& [part, next] : kNextBelow) {
      const auto above = frames.find(part, side), below = frames.find(next, side);
      if (!above || !below) continue;
      int carrier = *below;
      while (carrier >= 0 && carrier != *above) carrier = armature.bones[static_cast<std::size_t>(carrier)].parent;
      if (carrier < 0)
        names += (names.empty() ? "" : ", ") + armature.bones[static_cast<std::size_t>(*below)].name + " from " +
                 armature.bones[static_cast<std::size_t>(*above)].name;
    }
  return names.empty()
             ? ""
             : "these limb bones are not children of the bone above them, so they do not move with it: " + names;
}

std::vector<int> bones_of_joints(const BodyFrames& frames, const JointAngles& angles) {
  std::vector<int> all;
  for (const auto& [joint, motions] : angles) {
    const std::vector<int> bones = bones_turned_by(frames, joint);
    all.insert(all.end(), bones.begin(), bones.end());
  }
  return all;
}

std::string joints_of_rig(const BodyFrames& frames) {
  std::string names;
  for (const BodyJoint joint : kAllJoints)
    for (const BodySide side : {BodySide::Left, BodySide::Right, BodySide::Middle}) {
      if ((side == BodySide::Middle || is_paired(joint)) && has_joint(frames, {joint, side}))
        names += (names.empty() ? "" : ", ") + name_of({joint, side});
    }
  return names;
}

std::string beyond_limits(const Armature& armature, const Pose& pose) {
  constexpr double kShown = 0.05;  // degrees; a bone that exceeds its limits by less is not listed
  constexpr int kNamed = 8;
  std::string names;
  int count = 0;
  for (std::size_t b = 0; b < armature.bones.size(); ++b) {
    const double beyond = limit_excess(armature.bones[b], pose.rotation[b]) * 180 / std::numbers::pi;
    if (beyond <= kShown || ++count > kNamed) continue;
    char degrees[32];
    std::snprintf(degrees, sizeof degrees, " by %.1f", beyond);
    names += (names.empty() ? "" : ", ") + armature.bones[b].name + degrees;
  }
  if (count > kNamed) names += " and " + std::to_string(count - kNamed) + " more";
  return names.empty() ? "" : "the pose turns bones beyond the rig's limits, degrees: " + names;
}

}  // namespace limber
