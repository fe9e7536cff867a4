// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/body_frame.h"

#include <numbers>

namespace limber {

namespace {

constexpr BodySide kSides[] = {BodySide::Left, BodySide::Right};
constexpr BodyPart kFingers[] = {BodyPart::Thumb, BodyPart::Index, BodyPart::Middle, BodyPart::Ring, BodyPart::Little};

}  // namespace

glm::dquat shortest_turn(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 axis = glm::cross(a, b);
  const double sine = glm::length(axis);
  if (sine > 1e-12) return glm::angleAxis(std::atan2(sine, glm::dot(a, b)), axis / sine);
  if (glm::dot(a, b) > 0) return {1, 0, 0, 0};
  if (!(glm::length(a) > 0 && glm::length(b) > 0)) return {1, 0, 0, 0};
  // The directions are opposite: returns a half turn about any axis perpendicular to `a`.
  const glm::dvec3 across = glm::cross(a, std::abs(a.z) < 0.9 * glm::length(a) ? kUp : glm::dvec3(1, 0, 0));
  return glm::angleAxis(std::numbers::pi, glm::normalize(across));
}

std::optional<glm::dmat3> axes_of(const glm::dvec3& main, const glm::dvec3& side) {
  const glm::dvec3 across = side - main * (glm::dot(side, main) / std::max(glm::dot(main, main), 1e-300));
  if (glm::length(across) < 0.05 * glm::length(side) || glm::length(main) < 1e-9 || glm::length(side) < 1e-9)
    return std::nullopt;
  const glm::dvec3 z = glm::normalize(main), x = glm::normalize(across);
  return glm::dmat3(x, glm::cross(z, x), z);
}

namespace {

void name_roles(Skeleton& skeleton, const std::vector<std::string>& names) {
  skeleton.role = joint_roles(names, skeleton.parents);
  for (size_t j = 0; j < names.size(); ++j)
    if (skeleton.role[j]) skeleton.joint[*skeleton.role[j]] = static_cast<int>(j);
}

}  // namespace

Skeleton skeleton_of(const Armature& armature) {
  Skeleton skeleton;
  std::vector<std::string> names;
  for (const Bone& bone : armature.bones) {
    skeleton.parents.push_back(bone.parent);
    skeleton.place.push_back(bone.head);
    skeleton.tip.push_back(bone.tail);
    names.push_back(bone.name);
  }
  name_roles(skeleton, names);
  return skeleton;
}

void place_joints(Skeleton& skeleton, const Motion& motion, int frame) {
  const auto world = forward_kinematics(motion, frame);
  const size_t count = world.size();
  skeleton.place.resize(count);
  skeleton.tip.assign(count, glm::dvec3(0));
  for (size_t j = 0; j < count; ++j) skeleton.place[j] = lps_from_bvh(world[j].translation);
  std::vector<int> children(count, 0);
  for (size_t j = count; j-- > 0;) {
    const auto& end = motion.joints[j].end_site;
    if (children[j] > 0) skeleton.tip[j] /= double(children[j]);
    else skeleton.tip[j] = end ? lps_from_bvh(world[j] * *end) : skeleton.place[j];
    const int parent = motion.joints[j].parent;
    if (parent < 0) continue;
    const glm::dvec3 seen = skeleton.place[j] == skeleton.place[parent] ? skeleton.tip[j] : skeleton.place[j];
    if (seen == skeleton.place[parent]) continue;
    skeleton.tip[parent] += seen;
    ++children[parent];
  }
}

Skeleton skeleton_of(const Motion& motion) {
  Skeleton skeleton;
  std::vector<std::string> names;
  for (const BvhJoint& joint : motion.joints) {
    skeleton.parents.push_back(joint.parent);
    names.push_back(joint.name);
  }
  name_roles(skeleton, names);
  place_joints(skeleton, motion, -1);
  return skeleton;
}

namespace {

std::optional<glm::dvec3> mean_knuckle(const Skeleton& skeleton, BodySide side) {
  glm::dvec3 sum(0);
  int count = 0;
  for (BodyPart finger : kFingers)
    if (const auto knuckle = skeleton.place_of(finger, side, 1); knuckle && finger != BodyPart::Thumb)
      sum += *knuckle, ++count;
  return count ? std::optional(sum / double(count)) : std::nullopt;
}

}  // namespace

glm::dvec3 direction_of(const Skeleton& skeleton, int joint) {
  const glm::dvec3 here = skeleton.place[joint];
  std::optional<glm::dvec3> there;
  if (const auto& role = skeleton.role[joint]) {
    switch (role->part) {
      case BodyPart::Clavicle: there = skeleton.place_of(BodyPart::UpperArm, role->side); break;
      case BodyPart::UpperArm: there = skeleton.place_of(BodyPart::Forearm, role->side); break;
      case BodyPart::Forearm: there = skeleton.place_of(BodyPart::Hand, role->side); break;
      case BodyPart::Hand: there = mean_knuckle(skeleton, role->side); break;
      case BodyPart::Thigh: there = skeleton.place_of(BodyPart::Shank, role->side); break;
      case BodyPart::Shank: there = skeleton.place_of(BodyPart::Foot, role->side); break;
      case BodyPart::Foot: there = skeleton.place_of(BodyPart::Toes, role->side); break;
      case BodyPart::Thumb:
      case BodyPart::Index:
      case BodyPart::Middle:
      case BodyPart::Ring:
      case BodyPart::Little: there = skeleton.place_of(role->part, role->side, role->index + 1); break;
      default: break;
    }
  }
  if (there && glm::length(*there - here) > 1e-9) return *there - here;
  return skeleton.tip[joint] - here;
}

namespace {

// Returns the vector from the right joint of `part` to the left one; nothing if the skeleton lacks one of them. Thighs
// give the line through the hips, upper arms the line through the shoulders.
std::optional<glm::dvec3> across(const Skeleton& skeleton, BodyPart part) {
  const auto left = skeleton.place_of(part, BodySide::Left), right = skeleton.place_of(part, BodySide::Right);
  return left && right && glm::length(*left - *right) > 1e-9 ? std::optional(*left - *right) : std::nullopt;
}

std::optional<glm::dvec3> neck_base(const Skeleton& skeleton) {
  if (const auto neck = skeleton.place_of(BodyPart::Neck, BodySide::Middle)) return neck;
  const auto left = skeleton.place_of(BodyPart::UpperArm, BodySide::Left),
             right = skeleton.place_of(BodyPart::UpperArm, BodySide::Right);
  if (left && right) return (*left + *right) / 2.0;
  return skeleton.place_of(BodyPart::Head, BodySide::Middle);
}

}  // namespace

std::optional<glm::dvec3> trunk_line(const Skeleton& skeleton) {
  const auto neck = neck_base(skeleton);
  auto hips = skeleton.place_of(BodyPart::Pelvis, BodySide::Middle);
  const auto left = skeleton.place_of(BodyPart::Thigh, BodySide::Left),
             right = skeleton.place_of(BodyPart::Thigh, BodySide::Right);
  if (left && right) hips = (*left + *right) / 2.0;
  return neck && hips && glm::length(*neck - *hips) > 1e-9 ? std::optional(*neck - *hips) : std::nullopt;
}

std::optional<glm::dmat3> body_axes(const Skeleton& skeleton, BodyPart part) {
  const auto line = trunk_line(skeleton), side = across(skeleton, part);
  return line && side ? axes_of(*line, *side) : std::nullopt;
}

namespace {

// Measures how far a skeleton is from a standing pose: how many radians its limbs deviate from that pose beyond a
// tolerance, on average. In the standing pose the legs point down, the feet forward, and the arms to the sides or down;
// limbs are straight, and left and right are mirror images. Angles are measured in the body's own axes. Returns nothing
// for a skeleton that has no trunk or no pair of thighs.
std::optional<double> unlike_standing(const Skeleton& skeleton) {
  const auto axes = body_axes(skeleton, BodyPart::Thigh);
  if (!axes) return std::nullopt;
  const glm::dmat3 body_from_world = glm::transpose(*axes);
  double sum = 0;
  int count = 0;
  auto add = [&](double angle, double free) { sum += std::max(0.0, angle - free), ++count; };
  auto limb = [&](BodyPart part, BodySide side) -> std::optional<glm::dvec3> {
    const auto found = skeleton.joint.find({part, side});
    if (found == skeleton.joint.end()) return std::nullopt;
    const glm::dvec3 direction = body_from_world * direction_of(skeleton, found->second);
    return glm::length(direction) > 1e-9 ? std::optional(glm::normalize(direction)) : std::nullopt;
  };

  for (BodyPart part : {BodyPart::UpperArm, BodyPart::Forearm, BodyPart::Thigh, BodyPart::Shank, BodyPart::Foot}) {
    const auto left = limb(part, BodySide::Left), right = limb(part, BodySide::Right);
    if (left && right) add(angle_between(*left * glm::dvec3(-1, 1, 1), *right), 0.1);
    const bool is_leg = part == BodyPart::Thigh || part == BodyPart::Shank, is_foot = part == BodyPart::Foot;
    for (const auto& direction : {left, right})
      // In the body's axes (left, back, up), a foot points forward along -y.
      if (direction && (is_leg || is_foot))
        add(angle_between(*direction, is_leg ? -kUp : glm::dvec3(0, -1, 0)), is_leg ? 0.35 : 0.7);
  }
  for (BodySide side : kSides) {
    const auto upper = limb(BodyPart::UpperArm, side), fore = limb(BodyPart::Forearm, side);
    // An upper arm may point anywhere between hanging down and spread to the side.
    const double outward = side == BodySide::Left ? 1 : -1;
    if (upper) add(std::max(0.0, angle_between(*upper, glm::normalize(glm::dvec3(outward, 0, -1)))), 0.9);
    if (upper && fore) add(angle_between(*upper, *fore), 0.5);
  }
  return count ? std::optional(sum / count) : std::nullopt;
}

}  // namespace

int standing_frame(const Motion& motion, Skeleton skeleton) {
  place_joints(skeleton, motion, -1);
  const auto rest = unlike_standing(skeleton);
  // Returns -1 (the rest pose) for a skeleton without legs, since no frame can then show whether the body stands. Also
  // returns -1 if the rest pose is within 0.2 radians (11 degrees) of standing.
  if (!rest && (body_axes(skeleton, BodyPart::UpperArm) || !trunk_line(skeleton))) return -1;
  if (rest && *rest < 0.2) return -1;
  double best = rest.value_or(1e9);
  int best_frame = -1;
  const int step = std::max(1, motion.frame_count / 200);
  for (int frame = 0; frame < motion.frame_count; frame += step) {
    place_joints(skeleton, motion, frame);
    const auto unlike = unlike_standing(skeleton);
    if (unlike && *unlike < best - 1e-9) best = *unlike, best_frame = frame;
  }
  return best_frame;
}

}  // namespace limber
