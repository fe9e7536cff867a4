// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/finger_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/pose/joint_turns.h"
#include "core/rig/joint_limits.h"

namespace limber {

namespace {

constexpr BodyPart kFingers[] = {BodyPart::Index, BodyPart::Middle, BodyPart::Ring, BodyPart::Little};
// Curl of a finger (sum of the sines of its joints' bends) above which the finger shows the plane in which it bends; 30
// degrees in one joint give 0.5.
constexpr double kCurled = 0.5;
// Cosine of the largest angle (37 degrees) between the axis of a finger's curl and the line across the palm. A finger
// beyond this angle is crooked, so its curl does not show the axis about which it bends.
constexpr double kAskew = 0.8;
// Curl of a hand (sum of the sines of the bends of all finger joints) above which the direction of the curl tells a
// left hand from a right hand; 15 degrees in one joint give 0.26.
constexpr double kSided = 0.26;

glm::dvec3 unit(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 1e-12 ? v / length : glm::dvec3(0);
}

std::optional<int> bone_of(const Skeleton& skeleton, BodyPart part, BodySide side, int index) {
  const auto found = skeleton.joint.find({part, side, index});
  return found == skeleton.joint.end() ? std::nullopt : std::optional(found->second);
}

// Returns the position of a finger's knuckle, which is the joint between palm and finger; nothing if the rig lacks it.
std::optional<glm::dvec3> knuckle(const Skeleton& skeleton, BodyPart finger, BodySide side) {
  if (const auto place = skeleton.place_of(finger, side, 1)) return place;
  const auto metacarpal = bone_of(skeleton, finger, side, 0);
  return metacarpal ? std::optional(skeleton.tip[*metacarpal]) : std::nullopt;
}

std::optional<glm::dvec3> wrist(const Skeleton& skeleton, BodySide side) {
  if (const auto hand = skeleton.place_of(BodyPart::Hand, side)) return hand;
  const auto forearm = bone_of(skeleton, BodyPart::Forearm, side, 0);
  return forearm ? std::optional(skeleton.tip[*forearm]) : std::nullopt;
}

// Returns the bone of the finger's outermost segment; nothing if the finger has no bones.
std::optional<int> last_segment(const Skeleton& skeleton, BodyPart finger, BodySide side) {
  for (int segment = 3; segment >= 1; --segment)
    if (const auto bone = bone_of(skeleton, finger, side, segment)) return bone;
  return std::nullopt;
}

struct Finger {
  std::vector<int> bones;  // indices of the finger's bones, from the knuckle to the tip
  // Unit vectors. The first is the direction of the palm or metacarpal before the finger; one for each bone follows.
  std::vector<glm::dvec3> directions;
};

Finger finger_of(const Skeleton& skeleton, BodyPart part, BodySide side) {
  Finger finger;
  for (int segment = 1; segment <= 3; ++segment)
    if (const auto bone = bone_of(skeleton, part, side, segment)) finger.bones.push_back(*bone);
  if (finger.bones.empty()) return finger;
  const auto metacarpal = bone_of(skeleton, part, side, 0);
  const auto from = wrist(skeleton, side);
  const glm::dvec3 first = skeleton.place[finger.bones.front()];
  glm::dvec3 before = metacarpal ? first - skeleton.place[*metacarpal] : from ? first - *from : glm::dvec3(0);
  if (glm::length(before) < 1e-9) before = direction_of(skeleton, finger.bones.front());
  finger.directions.push_back(unit(before));
  for (const int bone : finger.bones) finger.directions.push_back(unit(direction_of(skeleton, bone)));
  return finger;
}

// Returns the axis about which the finger is curled. The vector's length is the sum of the sines of the angles between
// successive segments, if they all bend in one plane.
glm::dvec3 curl(const Finger& finger) {
  glm::dvec3 axis(0);
  for (std::size_t i = 1; i < finger.directions.size(); ++i)
    axis += glm::cross(finger.directions[i - 1], finger.directions[i]);
  return axis;
}

double bend(const glm::dvec3& before, const glm::dvec3& after, const glm::dvec3& axis) {
  const glm::dvec3 a = before - glm::dot(before, axis) * axis, b = after - glm::dot(after, axis) * axis;
  return glm::length(a) < 0.3 || glm::length(b) < 0.3 ? 0
                                                      : std::atan2(glm::dot(glm::cross(a, b), axis), glm::dot(a, b));
}

using Hinges = std::vector<std::pair<int, AnatomicalHinge>>;

// Sets the spread axis of a thumb's metacarpal: the axis about which it moves out of the palm's plane.
//   palmar  unit normal of the palm
void add_abduction(AnatomicalHinge& hinge, const glm::dvec3& bone, const glm::dvec3& palmar) {
  const glm::dvec3 axis = unit(glm::cross(bone, hinge.axis));
  if (axis == glm::dvec3(0) || palmar == glm::dvec3(0)) return;
  hinge.spread_axis = glm::dot(palmar, hinge.axis) < 0 ? -axis : axis;
  hinge.spread_at_rest = std::asin(std::clamp(glm::dot(bone, palmar), -1.0, 1.0));
}

// Sets the spread axis of a finger's first bone, so that a positive angle moves the bone in the direction `towards`.
//   level  unit direction of the bone without spread, at the knuckle's flexion at rest
void add_spreading(AnatomicalHinge& hinge, const glm::dvec3& bone, const glm::dvec3& towards, const glm::dvec3& level) {
  const glm::dvec3 axis = unit(glm::cross(bone, hinge.axis));
  if (axis == glm::dvec3(0) || level == glm::dvec3(0) || towards == glm::dvec3(0)) return;
  const double sign = glm::dot(towards, hinge.axis) < 0 ? -1 : 1;
  const auto rise = [&](const glm::dvec3& v) { return std::asin(std::clamp(glm::dot(v, hinge.axis), -1.0, 1.0)); };
  hinge.spread_axis = sign * axis;
  hinge.spread_at_rest = sign * (rise(bone) - rise(level));
}

void add_hinges(Hinges& hinges, const Armature& armature, const Finger& finger, const glm::dvec3& across) {
  if (finger.bones.empty()) return;
  const glm::dvec3 turning = curl(finger),
                   straight = unit(across - finger.directions[1] * glm::dot(across, finger.directions[1]));
  const bool curled =
      glm::length(turning) > kCurled && (straight == glm::dvec3(0) || glm::dot(unit(turning), straight) > kAskew);
  const glm::dvec3 axis = curled ? unit(turning) : straight;
  if (axis == glm::dvec3(0)) return;
  for (std::size_t i = 0; i < finger.bones.size(); ++i) {
    const JointLimits& limits = armature.bones[static_cast<std::size_t>(finger.bones[i])].limits;
    AnatomicalHinge hinge{axis, 0};
    if (limits.type == JointLimits::Type::Hinge)
      hinge.axis = glm::dot(limits.axis, axis) < 0 ? -limits.axis : limits.axis;
    hinge.at_rest = bend(finger.directions[i], finger.directions[i + 1], hinge.axis);
    hinges.emplace_back(finger.bones[i], hinge);
  }
}

}  // namespace

FingerAngles finger_angles(const AnatomicalHinge& hinge, const glm::dquat& rotation) {
  if (hinge.spread_axis == glm::dvec3(0)) return {hinge.at_rest + swing_twist(rotation, hinge.axis).twist, 0};
  const glm::dquat axes =
      glm::quat_cast(glm::dmat3(hinge.axis, hinge.spread_axis, glm::cross(hinge.axis, hinge.spread_axis)));
  const glm::dvec3 xyz = cardan_xyz(glm::conjugate(axes) * rotation * axes);
  // Two pairs of angles give the same rotation. Returns the pair with the smaller angles.
  constexpr double kPi = std::numbers::pi;
  const auto angles = [&](double bend, double aside) {
    return FingerAngles{std::remainder(hinge.at_rest + bend, 2 * kPi),
                        std::remainder(hinge.spread_at_rest + aside, 2 * kPi)};
  };
  const auto size = [](const FingerAngles& one) { return std::abs(one.flexion) + std::abs(one.spread); };
  const FingerAngles one = angles(xyz.x, xyz.y), other = angles(xyz.x + kPi, kPi - xyz.y);
  return size(one) <= size(other) ? one : other;
}

glm::dquat rotation_of_finger(const AnatomicalHinge& hinge, const FingerAngles& angles) {
  const glm::dquat bend = glm::angleAxis(angles.flexion - hinge.at_rest, hinge.axis);
  return angles.spread == hinge.spread_at_rest
             ? bend
             : bend * glm::angleAxis(angles.spread - hinge.spread_at_rest, hinge.spread_axis);
}

std::optional<glm::dvec3> along_hand(const Skeleton& skeleton, BodySide side) {
  const auto from = wrist(skeleton, side);
  if (!from) return std::nullopt;
  glm::dvec3 sum(0);
  int count = 0;
  for (const BodyPart finger : {BodyPart::Middle, BodyPart::Index, BodyPart::Ring, BodyPart::Little}) {
    const auto place = knuckle(skeleton, finger, side);
    if (!place) continue;
    if (finger == BodyPart::Middle) return *place - *from;
    sum += *place, ++count;
  }
  for (const BodyPart part : {BodyPart::Palm, BodyPart::Fingers})
    if (const auto place = skeleton.place_of(part, side); place && !count && glm::distance(*place, *from) > 1e-6)
      return *place - *from;
  return count ? std::optional(sum / double(count) - *from) : std::nullopt;
}

std::optional<glm::dvec3> across_palm(const Skeleton& skeleton, BodySide side) {
  std::vector<glm::dvec3> knuckles;
  for (const BodyPart finger : kFingers)
    if (const auto place = knuckle(skeleton, finger, side)) knuckles.push_back(*place);
  if (knuckles.size() >= 2 && glm::distance(knuckles.front(), knuckles.back()) > 1e-9)
    return knuckles.back() - knuckles.front();
  const auto thumb = last_segment(skeleton, BodyPart::Thumb, side);
  const auto from = wrist(skeleton, side);
  const auto hand = bone_of(skeleton, BodyPart::Hand, side, 0);
  if (!thumb || !from) return std::nullopt;
  const auto along = along_hand(skeleton, side);
  const glm::dvec3 axis = along ? unit(*along) : hand ? unit(skeleton.tip[*hand] - *from) : glm::dvec3(0);
  const glm::dvec3 thumb_side = skeleton.tip[*thumb] - *from, aside = thumb_side - axis * glm::dot(thumb_side, axis);
  return glm::length(aside) > 0.2 * glm::length(thumb_side) ? std::optional(-aside) : std::nullopt;
}

std::optional<bool> is_right_hand(const Skeleton& skeleton) {
  const auto across = across_palm(skeleton, BodySide::Middle);
  if (!across) return std::nullopt;
  glm::dvec3 turning(0);
  for (const BodyPart finger : kFingers) turning += curl(finger_of(skeleton, finger, BodySide::Middle));
  const double along_axis = glm::dot(turning, unit(*across));
  return std::abs(along_axis) > kSided ? std::optional(along_axis < 0) : std::nullopt;
}

Hinges finger_hinges(const Armature& armature, const Skeleton& skeleton, BodySide side, bool right) {
  Hinges hinges;
  const glm::dvec3 to_little = unit(across_palm(skeleton, side).value_or(glm::dvec3(0)));
  // The fingers of a left hand flex by a positive rotation about the axis from index to little finger. In a right hand
  // the axis is opposite.
  const glm::dvec3 across = right ? -to_little : to_little;
  for (const BodyPart part : kFingers) {
    const Finger finger = finger_of(skeleton, part, side);
    const std::size_t first = hinges.size();
    add_hinges(hinges, armature, finger, across);
    if (hinges.size() > first && bone_of(skeleton, part, side, 1) == hinges[first].first)
      add_spreading(hinges[first].second, finger.directions[1], part == BodyPart::Index ? -to_little : to_little,
                    finger.directions[0]);
  }
  // A thumb bends across the palm, towards the little finger.
  const Finger thumb = finger_of(skeleton, BodyPart::Thumb, side);
  if (!thumb.bones.empty()) {
    const std::size_t first = hinges.size();
    add_hinges(hinges, armature, thumb, unit(glm::cross(thumb.directions[1], to_little)));
    const glm::dvec3 palmar = unit(glm::cross(across, along_hand(skeleton, side).value_or(glm::dvec3(0))));
    if (hinges.size() > first && bone_of(skeleton, BodyPart::Thumb, side, 1) == hinges[first].first)
      add_abduction(hinges[first].second, thumb.directions[1], palmar);
  }
  if (const auto fingers = bone_of(skeleton, BodyPart::Fingers, side, 0)) {
    const glm::dvec3 along = along_hand(skeleton, side).value_or(skeleton.tip[*fingers] - skeleton.place[*fingers]);
    add_hinges(hinges, armature, {{*fingers}, {unit(along), unit(direction_of(skeleton, *fingers))}}, across);
  }
  return hinges;
}

}  // namespace limber
