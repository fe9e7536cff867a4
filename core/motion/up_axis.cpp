// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/up_axis.h"

#include <algorithm>
#include <optional>

#include "core/motion/body_frame.h"

namespace limber {

namespace {

// Cosine of 37 degrees; a body stands along an axis if its angle to the axis is smaller.
constexpr double kClear = 0.8;
constexpr int kMostFrames = 200;  // a motion with more frames is examined at 200 to 400 of them, to save time
// Shares of the examined frames. The z axis is up if the body stands along z in at least the share kMany of the frames
// and along y in less than the share kFew.
constexpr double kMany = 0.5, kFew = 0.1;
// An axis counts as up if the root moves along it by less than this share of its movement along the other one (y or z).
constexpr double kFlat = 0.2;

std::optional<glm::dvec3> mean_of(const Skeleton& skeleton, BodyPart part) {
  glm::dvec3 sum(0);
  int count = 0;
  for (BodySide side : {BodySide::Middle, BodySide::Left, BodySide::Right})
    if (const auto place = skeleton.place_of(part, side)) sum += *place, ++count;
  return count ? std::optional(sum / double(count)) : std::nullopt;
}

std::optional<glm::dvec3> first_of(const Skeleton& skeleton, std::initializer_list<BodyPart> parts) {
  for (BodyPart part : parts)
    if (const auto place = mean_of(skeleton, part)) return place;
  return std::nullopt;
}

// Returns the unit direction from the lowest body part that the joint names tell (feet at best) to the highest (head at
// best), in the file's axes. Returns nothing if the names tell no such parts.
std::optional<glm::dvec3> body_line(const Skeleton& skeleton) {
  const auto top = first_of(skeleton, {BodyPart::Head, BodyPart::Neck, BodyPart::UpperArm, BodyPart::Clavicle});
  const auto end = first_of(skeleton, {BodyPart::Foot, BodyPart::Shank, BodyPart::Thigh, BodyPart::Pelvis});
  if (!top || !end || glm::length(*top - *end) < 1e-9) return std::nullopt;
  return glm::normalize(bvh_from_lps(*top - *end));
}

std::optional<UpAxis> axis_of(const glm::dvec3& line) {
  if (line.y > kClear) return UpAxis::Y;
  return line.z > kClear ? std::optional(UpAxis::Z) : std::nullopt;
}

std::optional<UpAxis> axis_over_frames(const Motion& motion, Skeleton& skeleton) {
  const int step = std::max(1, motion.frame_count / kMostFrames);
  int along_y = 0, along_z = 0, looked_at = 0;
  for (int frame = 0; frame < motion.frame_count; frame += step, ++looked_at) {
    place_joints(skeleton, motion, frame);
    const auto line = body_line(skeleton);
    const auto axis = line ? axis_of(*line) : std::nullopt;
    along_y += axis == UpAxis::Y;
    along_z += axis == UpAxis::Z;
  }
  // If an actor who lies along z gets up, the body stands along y in some frames. Even a few frames along y therefore
  // mean that y is up.
  if (along_z >= kMany * looked_at && along_y < kFew * looked_at && looked_at) return UpAxis::Z;
  return along_y > 0 && along_y >= kFew * looked_at ? std::optional(UpAxis::Y) : std::nullopt;
}

// Returns the axis (y or z) along which the root moves little while it travels far along the other one of them. Returns
// nothing if the root does not travel far.
std::optional<UpAxis> axis_by_travel(const Motion& motion) {
  glm::dvec3 low(1e300), high(-1e300);
  const int step = std::max(1, motion.frame_count / kMostFrames);
  std::vector<RigidTransform> world(motion.joints.size());
  for (int frame = 0; frame < motion.frame_count; frame += step) {
    place_joint(world, motion, frame, 0);
    low = glm::min(low, world[0].translation);
    high = glm::max(high, world[0].translation);
  }
  double longest = 0;
  for (const BvhJoint& joint : motion.joints) longest = std::max(longest, glm::length(joint.offset));
  const glm::dvec3 way = high - low;
  if (motion.frame_count == 0 || std::max(way.y, way.z) < 2 * longest) return std::nullopt;
  if (way.z < kFlat * way.y) return UpAxis::Z;
  return way.y < kFlat * way.z ? std::optional(UpAxis::Y) : std::nullopt;
}

}  // namespace

UpGuess up_axis_of(const Motion& motion) {
  if (motion.joints.empty()) return {};
  Skeleton skeleton = skeleton_of(motion);
  const auto rest = body_line(skeleton);
  if (rest)
    if (const auto axis = axis_over_frames(motion, skeleton)) return {*axis, UpGuess::By::Frames};
  if (const auto axis = rest ? axis_of(*rest) : std::nullopt) return {*axis, UpGuess::By::Rest};
  if (const auto axis = axis_by_travel(motion)) return {*axis, UpGuess::By::Travel};
  return {};
}

std::string reason_of(const UpGuess& guess) {
  const std::string axis = guess.axis == UpAxis::Z ? "z" : "y";
  switch (guess.by) {
    case UpGuess::By::Frames: return "over its frames the head is above the feet along " + axis;
    case UpGuess::By::Rest: return "at rest the head is above the feet along " + axis;
    case UpGuess::By::Travel: return "the body travels perpendicular to " + axis;
    case UpGuess::By::Nothing: break;
  }
  return "";
}

}  // namespace limber
