// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/anatomical_frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/motion/body_frame.h"
#include "core/pose/finger_frames.h"
#include "core/rig/joint_limits.h"

namespace limber {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;

// If the body's axes are this near to world axes, the world axes are used instead.
constexpr double kUprightLean = 7.5 * kDegree;
// Largest bend of a knee, and largest angle between leg and trunk seen from the side, at which the direction of the
// legs is used to find the body's upright axis.
constexpr double kStraightKnee = 20 * kDegree;
constexpr double kLegsInLine = 25 * kDegree;
// A knee bends at most this far sideways (varus, valgus); any further bend is taken as a turn of the thigh [Hsu 1990].
constexpr double kKneeAside = 5 * kDegree;
// An elbow bends at most this far sideways (half of the carrying angle); any further bend is taken as a turn of the
// arm.
constexpr double kElbowAside = 8 * kDegree;
constexpr double kHyperextension = 15 * kDegree;
// Range in which a foot points outwards (positive) relative to its knee [Staheli 1985]. A heading beyond it is taken as
// a turn of the thigh.
constexpr double kToeOut[] = {-5 * kDegree, 25 * kDegree};
// Range of the forearm's pronation, radians; 0: palm forward. A pronation beyond it is taken as a turn of the upper
// arm.
constexpr double kPronation[] = {-10 * kDegree, 175 * kDegree};
constexpr double kSoleSlope = 23 * kDegree;   // slope from the toes up to the ankle, with the sole on the ground
constexpr double kToeSlope = 8 * kDegree;     // slope from the toes' tips up to their base, with the sole on the ground
constexpr double kBackwards = 110 * kDegree;  // a foot turned further than this from forward points backwards
constexpr double kSteepFoot = 75 * kDegree;   // a foot that points down more steeply than this has no heading
// If the hand does not show where its palm faces, its pronation is assumed. If the upper arm is raised from hanging by
// more than this angle, the thumb is assumed to point forward, else the palm is assumed to face forward.
constexpr double kRaisedArm = 22.5 * kDegree;

const glm::dquat kNoTurn(1, 0, 0, 0);
const glm::dvec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);

glm::dquat about(const glm::dvec3& axis, double angle) { return glm::angleAxis(angle, axis); }

glm::dvec3 unit(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 1e-12 ? v / length : glm::dvec3(0);
}

// Converts between world axes and the body's axes (left, back, up). For a right limb the body's axes are mirrored, so
// that every limb can be treated as a left limb.
struct LimbView {
  glm::dmat3 body{1};
  bool right = false;

  glm::dvec3 seen(const glm::dvec3& world) const {
    const glm::dvec3 v = glm::transpose(body) * world;
    return {right ? -v.x : v.x, v.y, v.z};
  }
  // Converts an axis of rotation. Unlike a direction, it keeps its x component when mirrored; y and z change sign.
  glm::dvec3 seen_axis(const glm::dvec3& world) const {
    const glm::dvec3 v = glm::transpose(body) * world;
    return right ? glm::dvec3(v.x, -v.y, -v.z) : v;
  }
  glm::dquat world(const glm::dquat& q) const {
    const glm::dquat own = right ? glm::dquat(q.w, q.x, -q.y, -q.z) : q, axes = glm::quat_cast(body);
    return glm::normalize(axes * own * glm::conjugate(axes));
  }
  glm::dvec3 world_axis(const glm::dvec3& axis) const {
    return body * (right ? glm::dvec3(axis.x, -axis.y, -axis.z) : axis);
  }
};

// Returns the shortest rotation that moves a limb from hanging straight down to a direction. For the direction straight
// up, this is a half turn sideways.
glm::dquat swing_from_hanging(const glm::dvec3& direction) {
  if (direction == glm::dvec3(0)) return kNoTurn;
  if (direction.z > 1 - 1e-9) return about(kY, kPi);
  return shortest_turn(-kZ, direction);
}

// Returns the angle, radians, by which the upper limb must rotate about its own length so that its knee or elbow bends
// towards `bend_heading` and at most by `aside` to the side. Of all such angles, returns the one nearest to `wanted`.
//   below   direction of the lower limb, in the upper limb's axes
//   wanted  the angle for a straight joint
double turn_about_itself(const glm::dvec3& below, double bend_heading, double aside, double wanted) {
  const double across = std::hypot(below.x, below.y), bend = std::atan2(across, -below.z);
  if (across <= std::sin(aside) && below.z <= 0) return wanted;
  const double plane = std::atan2(below.y, below.x) - bend_heading;
  const double room = std::asin(std::min(1.0, std::sin(aside) / std::max(across, 1e-12)));
  const double from_plane = std::remainder(wanted - plane, 2 * kPi);
  if (bend < kHyperextension && std::abs(from_plane) > kPi / 2) {
    const double from_back = std::remainder(wanted - plane - kPi, 2 * kPi);
    return wanted - from_back + std::clamp(from_back, -room, room);
  }
  return wanted - from_plane + std::clamp(from_plane, -room, room);
}

class Measuring {
 public:
  Measuring(const Armature& armature, BodyFrames& result)
      : armature_(armature),
        skeleton_(skeleton_of(armature)),
        result_(result) {
    result_.bone = skeleton_.joint;
    result_.frames.resize(armature.bones.size());
    done_.assign(armature.bones.size(), false);
  }

  void measure_side(BodySide side) {
    view_ = {result_.body, is_right(side)};
    result_.is_right[side] = view_.right;
    leg(side);
    arm(side);
  }

  // Gives each bone that was not measured the rotation of its parent.
  void fill() {
    for (std::size_t b = 0; b < done_.size(); ++b) {
      const int parent = armature_.bones[b].parent;
      if (!done_[b] && parent >= 0)
        result_.frames[b].anatomical_from_rest = result_.frames[parent].anatomical_from_rest;
    }
  }

 private:
  std::optional<int> find(BodyPart part, BodySide side, int index = 0) const { return result_.find(part, side, index); }

  glm::dvec3 direction(int bone) const { return unit(view_.seen(direction_of(skeleton_, bone))); }

  const JointLimits* hinge_of(int bone) const {
    const JointLimits& limits = armature_.bones[bone].limits;
    return limits.type == JointLimits::Type::Hinge ? &limits : nullptr;
  }

  bool is_right(BodySide side) const {
    if (side != BodySide::Middle) return side == BodySide::Right;
    if (const auto hand = is_right_hand(skeleton_)) return *hand;
    // A single limb whose names tell no side belongs to the side towards which its lower end lies.
    for (const auto& [above, below] : {std::pair{BodyPart::Thigh, BodyPart::Foot},
                                       {BodyPart::UpperArm, BodyPart::Hand},
                                       {BodyPart::UpperArm, BodyPart::Forearm}}) {
      const auto from = skeleton_.place_of(above, side), to = skeleton_.place_of(below, side);
      if (from && to) return glm::dot(*to - *from, result_.body[0]) < 0;
    }
    return false;
  }

  void set(int bone, const glm::dquat& frame_at_rest, const glm::dquat& axes = kNoTurn) {
    result_.frames[bone].anatomical_from_rest = glm::conjugate(view_.world(frame_at_rest));
    result_.frames[bone].joint_axes = view_.world(axes);
    done_[bone] = true;
  }

  void set_hinge(int bone, const glm::dvec3& flexion_axis, double at_rest) {
    const glm::dvec3 axis = hinge_of(bone)->axis;
    const double sign = glm::dot(axis, view_.world_axis(flexion_axis)) < 0 ? -1 : 1;
    result_.frames[bone].hinge = AnatomicalHinge{sign * axis, at_rest};
  }

  // Returns the angle, radians, by which the hinge axis of `bone` is rotated about the length of the limb above it.
  // Returns nothing if the bone has no hinge, or if the hinge axis runs along this limb.
  //   swung  the frame of the limb above, without a rotation about its length
  //   sign   +1 or -1: the sign of the rotation about x that flexes the joint
  std::optional<double> turn_of_hinge(int bone, const glm::dquat& swung, double sign) const {
    if (!hinge_of(bone)) return std::nullopt;
    glm::dvec3 axis = glm::conjugate(swung) * view_.seen_axis(hinge_of(bone)->axis) * sign;
    if (std::hypot(axis.x, axis.y) < 0.3) return std::nullopt;
    return std::atan2(axis.y, axis.x);
  }

  // Returns the frame of a lower limb (shank or forearm), including the bend at knee or elbow.
  //   sign  +1 or -1: the sign of the rotation about x that flexes the joint
  glm::dquat bent_frame(int bone, const glm::dquat& above, double sign) {
    const glm::dvec3 below = direction(bone) == glm::dvec3(0) ? -kZ : glm::conjugate(above) * direction(bone);
    if (!hinge_of(bone)) {
      const glm::dquat bend = about(kX, std::atan2(below.y, -below.z));
      return above * bend * about(kY, -std::asin(std::clamp(below.x, -1.0, 1.0)));
    }
    set_hinge(bone, above * (sign * kX), 0);
    AnatomicalHinge& hinge = *result_.frames[bone].hinge;
    const glm::dvec3 axis = glm::conjugate(above) * view_.seen_axis(hinge.axis);
    const glm::dvec3 straight = -kZ - axis * glm::dot(-kZ, axis), bent = below - axis * glm::dot(below, axis);
    hinge.at_rest = std::atan2(glm::dot(glm::cross(straight, bent), axis), glm::dot(straight, bent));
    return above * about(axis, hinge.at_rest);
  }

  void leg(BodySide side);
  void foot(int bone, const glm::dquat& shank, double heading, const glm::dvec3& seen);
  void arm(BodySide side);
  double pronation_of_hand(BodySide side, const glm::dquat& forearm, double raised) const;
  void hand(BodySide side, const glm::dquat& forearm, double pronation);

  const Armature& armature_;
  Skeleton skeleton_;
  BodyFrames& result_;
  LimbView view_;
  std::vector<char> done_;
};

double excess(double angle, const double (&range)[2]) { return angle - std::clamp(angle, range[0], range[1]); }

double heading_of(const glm::dvec3& foot) {
  const double level = std::hypot(foot.x, foot.y);
  return level == 0 || std::atan2(-foot.z, level) > kSteepFoot ? (kToeOut[0] + kToeOut[1]) / 2
                                                               : std::atan2(foot.x, -foot.y);
}

void Measuring::leg(BodySide side) {
  const auto thigh = find(BodyPart::Thigh, side), shank = find(BodyPart::Shank, side),
             foot_bone = find(BodyPart::Foot, side);
  const glm::dquat swung = thigh ? swing_from_hanging(direction(*thigh)) : kNoTurn;
  double turn = 0;
  if (thigh && shank) {
    if (foot_bone) {
      const double heading = heading_of(glm::conjugate(bent_frame(*shank, swung, 1)) * direction(*foot_bone));
      if (std::abs(heading) < kBackwards) turn = excess(heading, kToeOut);
      else result_.feet_point_back = true;
    }
    const auto hinge = turn_of_hinge(*shank, swung, 1);
    turn = hinge ? *hinge : turn_about_itself(glm::conjugate(swung) * direction(*shank), kPi / 2, kKneeAside, turn);
  }
  const glm::dquat thigh_frame = swung * about(kZ, turn);
  if (thigh) set(*thigh, thigh_frame);
  if (!shank) return;
  const glm::dquat shank_frame = thigh ? bent_frame(*shank, thigh_frame, 1) : swing_from_hanging(direction(*shank));
  set(*shank, shank_frame);
  if (!foot_bone) return;
  const glm::dvec3 seen = glm::conjugate(shank_frame) * direction(*foot_bone);
  // A foot that points backwards is not measured and keeps its pose relative to the shank, because either its bone runs
  // to the heel, or left and right are swapped in the names.
  if (std::abs(heading_of(seen)) < kBackwards) foot(*foot_bone, shank_frame, heading_of(seen), seen);
}

// Sets the frames of foot and toes. If the foot has toes, they determine its pitch in the anatomical position: the
// slope of toes on the ground is known, and the angle between foot and toes stays as it is at rest.
//   shank          the frame of the shank
//   heading, seen  the heading of the foot and its direction, in this frame
void Measuring::foot(int bone, const glm::dquat& shank, double heading, const glm::dvec3& seen) {
  const auto slope = [&](const glm::dvec3& v) { return std::atan2(-v.z, glm::dot(v, about(kZ, heading) * -kY)); };
  double neutral = kSoleSlope;
  const JointRole role = *skeleton_.role[bone];
  const auto toes = find(BodyPart::Toes, role.side);
  if (toes && direction(*toes) != glm::dvec3(0)) {
    const double shape = slope(seen) - slope(glm::conjugate(shank) * direction(*toes));
    if (shape > -10 * kDegree && shape < 55 * kDegree) neutral = kToeSlope + shape;
  }
  const double dorsiflexion = neutral - slope(seen);
  const double kept = std::clamp(heading, kToeOut[0], kToeOut[1]);
  const glm::dquat at_rest = about(kZ, heading) * about(kX, -dorsiflexion) * about(kZ, -kept);
  set(bone, shank * at_rest, about(kZ, kept));
  if (hinge_of(bone)) {
    set_hinge(bone, shank * about(kZ, heading) * -kX, dorsiflexion);
    const glm::dvec3 axis = glm::conjugate(shank) * view_.seen_axis(result_.frames[bone].hinge->axis);
    set(bone, shank * about(axis, dorsiflexion), about(kZ, kept));
  }
  if (!toes) return;
  // The toes keep the angle to the foot that they have at rest.
  set(*toes, shank * at_rest, about(kZ, kept));
  if (hinge_of(*toes)) set_hinge(*toes, shank * about(kZ, heading) * -kX, 0);
}

void Measuring::arm(BodySide side) {
  const auto upper = find(BodyPart::UpperArm, side), forearm = find(BodyPart::Forearm, side);
  const glm::dquat swung = upper ? swing_from_hanging(direction(*upper)) : kNoTurn;
  const double raised = upper ? angle_between(direction(*upper), -kZ) : 0;
  double turn = 0;
  if (upper && forearm) {
    turn = -excess(pronation_of_hand(side, bent_frame(*forearm, swung, -1), raised), kPronation);
    const auto hinge = turn_of_hinge(*forearm, swung, -1);
    turn = hinge ? *hinge : turn_about_itself(glm::conjugate(swung) * direction(*forearm), -kPi / 2, kElbowAside, turn);
  }
  const glm::dquat upper_frame = swung * about(kZ, turn);
  if (upper) set(*upper, upper_frame);
  if (!forearm) return hand(side, kNoTurn, 0);

  const glm::dquat bent = upper ? bent_frame(*forearm, upper_frame, -1) : swing_from_hanging(direction(*forearm));
  auto& pronation = result_.pronation[side];
  pronation.at_rest = pronation_of_hand(side, bent, raised);
  // A forearm with a hinge cannot turn about its own length, so the hand takes the whole pronation.
  pronation.forearm_share = hinge_of(*forearm) || *forearm == result_.only_root ? 0
                            : find(BodyPart::Hand, side)                        ? 0.5
                                                                                : 1;
  set(*forearm, bent * about(kZ, -pronation.forearm_share * pronation.at_rest));
  hand(side, bent, pronation.at_rest);
}

// Returns the forearm's pronation, radians in the range of -90 to 270 degrees, found from the direction in which the
// palm faces. It is 0 if the palm faces forward.
//   raised  angle between the upper arm and a hanging arm, radians
double Measuring::pronation_of_hand(BodySide side, const glm::dquat& forearm, double raised) const {
  const auto across = across_palm(skeleton_, side);
  const auto along = along_hand(skeleton_, side);
  const auto frame = across && along ? axes_of(-view_.seen(*along), -view_.seen(*across)) : std::nullopt;
  if (!frame) return raised > kRaisedArm ? kPi / 2 : 0;
  const double twist = swing_twist(glm::conjugate(forearm) * glm::quat_cast(*frame), kZ).twist;
  const double pronation = std::remainder(-twist, 2 * kPi);
  return pronation < -kPi / 2 ? pronation + 2 * kPi : pronation;
}

void Measuring::hand(BodySide side, const glm::dquat& forearm, double pronation) {
  const auto bone = find(BodyPart::Hand, side);
  const auto across = across_palm(skeleton_, side);
  const auto along = along_hand(skeleton_, side);
  if (bone) {
    const glm::dvec3 seen = along ? unit(view_.seen(*along)) : direction(*bone);
    const auto frame = across ? axes_of(-seen, -view_.seen(*across)) : std::nullopt;
    const glm::dquat turned = forearm * about(kZ, -pronation);
    const glm::dquat swung = seen == glm::dvec3(0) ? turned : shortest_turn(turned * -kZ, seen) * turned;
    set(*bone, frame ? glm::normalize(glm::quat_cast(*frame)) : swung);
  }
  for (const auto& [finger, hinge] : finger_hinges(armature_, skeleton_, side, view_.right))
    result_.frames[finger].hinge = hinge;
}

// Replaces each of the given axes by the world axis, with its sign, that is nearest to it.
glm::dmat3 nearest_world_axes(const glm::dmat3& axes) {
  glm::dmat3 nearest(0);
  for (int column = 0; column < 3; ++column) {
    int most = 0;
    for (int row = 1; row < 3; ++row)
      if (std::abs(axes[column][row]) > std::abs(axes[column][most])) most = row;
    nearest[column][most] = axes[column][most] < 0 ? -1 : 1;
  }
  return nearest;
}

// Returns the upward direction along the legs if both legs are straight and, seen from the side, in line with the
// trunk; else zero.
glm::dvec3 up_of_legs(const Skeleton& skeleton, const glm::dvec3& trunk, const glm::dvec3& across) {
  const auto from_the_side = [&](const glm::dvec3& v) { return v - unit(across) * glm::dot(v, unit(across)); };
  glm::dvec3 up(0);
  for (const BodySide side : {BodySide::Left, BodySide::Right}) {
    const auto hip = skeleton.place_of(BodyPart::Thigh, side), knee = skeleton.place_of(BodyPart::Shank, side),
               ankle = skeleton.place_of(BodyPart::Foot, side);
    if (!hip || !knee || !ankle) return glm::dvec3(0);
    const glm::dvec3 leg = *hip - *ankle;
    const bool straight = angle_between(*hip - *knee, *knee - *ankle) < kStraightKnee;
    if (!straight || angle_between(from_the_side(leg), from_the_side(trunk)) > kLegsInLine) return glm::dvec3(0);
    up += unit(leg);
  }
  return up;
}

}  // namespace

std::optional<int> BodyFrames::find(BodyPart part, BodySide side, int index) const {
  const auto found = bone.find({part, side, index});
  return found == bone.end() ? std::nullopt : std::optional(found->second);
}

glm::dmat3 upright_axes(const Armature& armature) {
  const Skeleton skeleton = skeleton_of(armature);
  const auto trunk = trunk_line(skeleton);
  if (!trunk) return glm::dmat3(1);
  glm::dvec3 across(0);
  for (const BodyPart part : {BodyPart::Thigh, BodyPart::UpperArm}) {
    const auto left = skeleton.place_of(part, BodySide::Left), right = skeleton.place_of(part, BodySide::Right);
    if (left && right) across += *left - *right;
  }
  // In an upright body, the neck is further back than the hips, and the ankles are further back than the hips too. The
  // lines along trunk and legs therefore lean in opposite directions, and their mean is upright.
  const glm::dvec3 legs = up_of_legs(skeleton, *trunk, across);
  const glm::dvec3 up = legs == glm::dvec3(0) ? *trunk : unit(*trunk) + unit(legs);
  const std::optional<glm::dmat3> axes = axes_of(up, across);
  if (!axes) return glm::dmat3(1);
  const glm::dmat3 world = nearest_world_axes(*axes);
  if (std::abs(glm::determinant(world) - 1) > 0.5) return *axes;
  const glm::dmat3 between = glm::transpose(world) * *axes;
  const double angle = std::acos(std::clamp((between[0][0] + between[1][1] + between[2][2] - 1) / 2, -1.0, 1.0));
  return angle <= kUprightLean ? world : *axes;
}

BodyFrames body_frames(const Armature& armature) {
  BodyFrames result;
  result.body = upright_axes(armature);
  const auto is_root = [](const Bone& bone) { return bone.parent < 0; };
  const auto root = std::find_if(armature.bones.begin(), armature.bones.end(), is_root);
  if (std::count_if(armature.bones.begin(), armature.bones.end(), is_root) == 1)
    result.only_root = static_cast<int>(root - armature.bones.begin());
  Measuring measuring(armature, result);
  for (const BodySide side : {BodySide::Middle, BodySide::Left, BodySide::Right}) measuring.measure_side(side);
  measuring.fill();
  return result;
}

}  // namespace limber
