// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/motion_edit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace limber {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr std::int64_t kMostFrames = 10'000'000;
constexpr int kFramesAtOnce = 256;  // frames per step of the resampling between two progress reports; under 10 ms

bool is_rotation(BvhChannel channel) { return channel >= BvhChannel::Xrotation; }
int axis_of(BvhChannel channel) { return static_cast<int>(channel) % 3; }

double nearest_turn(double angle, double near) { return angle + kTurn * std::round((near - angle) / kTurn); }
glm::dvec3 nearest_turns(glm::dvec3 angles, const glm::dvec3& near) {
  for (int i = 0; i < 3; ++i) angles[i] = nearest_turn(angles[i], near[i]);
  return angles;
}

glm::dquat about(int axis, double angle) {
  glm::dvec3 unit(0);
  unit[axis] = 1;
  return glm::angleAxis(angle, unit);
}

glm::dvec3 rotation_values(const BvhJoint& joint, const float* row) {
  glm::dvec3 values(0);
  int count = 0;
  for (std::size_t c = 0; c < joint.channels.size(); ++c)
    if (is_rotation(joint.channels[c]) && count < 3)
      values[count++] = glm::radians(static_cast<double>(row[joint.first_channel + c]));
  return values;
}

void put_rotation(const BvhJoint& joint, const glm::dvec3& angles, float* row) {
  int count = 0;
  for (std::size_t c = 0; c < joint.channels.size(); ++c)
    if (is_rotation(joint.channels[c]))
      row[joint.first_channel + c] = static_cast<float>(glm::degrees(angles[count++]));
}

glm::dquat rotation_of(const std::array<int, 3>& order, const glm::dvec3& angles) {
  return about(order[0], angles[0]) * about(order[1], angles[1]) * about(order[2], angles[2]);
}

void mix_joint(const BvhJoint& joint, const float* low, const float* high, double share, float* row) {
  for (std::size_t c = 0; c < joint.channels.size(); ++c) {
    const std::size_t at = joint.first_channel + c;
    const double step = double{high[at]} - low[at];
    row[at] =
        static_cast<float>(low[at] + share * (is_rotation(joint.channels[c]) ? std::remainder(step, 360.0) : step));
  }
  const auto order = euler_order(joint);
  if (!order) return;
  const glm::dvec3 from = rotation_values(joint, low);
  const glm::dquat between =
      glm::slerp(rotation_of(*order, from), rotation_of(*order, rotation_values(joint, high)), share);
  put_rotation(joint, euler_angles(between, *order, from), row);
}

}  // namespace

std::optional<std::array<int, 3>> euler_order(const BvhJoint& joint) {
  std::array<int, 3> order{};
  int count = 0;
  for (BvhChannel channel : joint.channels) {
    if (!is_rotation(channel)) continue;
    if (count == 3) return std::nullopt;
    order[count++] = axis_of(channel);
  }
  const bool distinct = count == 3 && order[0] != order[1] && order[1] != order[2] && order[0] != order[2];
  return distinct ? std::optional(order) : std::nullopt;
}

glm::dvec3 euler_angles(const glm::dquat& rotation, const std::array<int, 3>& order, const glm::dvec3& near) {
  const auto [i, j, k] = order;
  const glm::dmat3 columns = glm::mat3_cast(rotation);
  const auto R = [&](int row, int column) { return columns[column][row]; };
  const double sign = (j - i + 3) % 3 == 1 ? 1 : -1;
  const double cosine = std::hypot(R(i, i), R(i, j));
  const double b = std::atan2(sign * R(i, k), cosine);
  // Gimbal lock: b is a right angle, so a and c rotate about the same axis. c is taken from `near`; a follows from
  // R_i(a) R_j(b) = rotation * R_k(-c).
  if (cosine < 1e-9) {
    const glm::dmat3 rest = glm::mat3_cast(rotation * about(k, -near[2]));
    return nearest_turns({std::atan2(sign * rest[j][k], rest[j][j]), b, near[2]}, near);
  }
  const glm::dvec3 one(std::atan2(-sign * R(j, k), R(k, k)), b, std::atan2(-sign * R(i, j), R(i, i)));
  const glm::dvec3 first = nearest_turns(one, near),
                   other = nearest_turns({one.x + kTurn / 2, kTurn / 2 - one.y, one.z + kTurn / 2}, near);
  const auto far = [&](const glm::dvec3& angles) { return glm::dot(glm::abs(angles - near), glm::dvec3(1)); };
  return far(other) < far(first) - 1e-9 ? other : first;
}

Motion y_up_from_z_up(const Motion& motion) {
  const auto turned = [](const glm::dvec3& v) { return glm::dvec3(v.x, v.z, -v.y); };
  Motion up = motion;
  for (BvhJoint& joint : up.joints) {
    joint.offset = turned(joint.offset);
    if (joint.end_site) joint.end_site = turned(*joint.end_site);
    for (std::size_t c = 0; c < joint.channels.size(); ++c) {
      const int axis = axis_of(joint.channels[c]), base = is_rotation(joint.channels[c]) ? 3 : 0;
      if (axis == 1)
        for (int frame = 0; frame < up.frame_count; ++frame) {
          float& value = up.values[static_cast<std::size_t>(frame) * up.channel_count + joint.first_channel + c];
          value = -value;
        }
      joint.channels[c] = static_cast<BvhChannel>(base + (axis == 0 ? 0 : 3 - axis));
    }
  }
  return up;
}

Motion resampled(const Motion& motion, double rate, Progress& progress) {
  if (!(rate >= 0.1 && rate <= 1000))
    throw Error("this rate cannot be used", std::to_string(rate) + " frames per second", "use a rate from 0.1 to 1000");
  const double seconds = std::max(0, motion.frame_count - 1) * motion.frame_time;
  const double count = std::floor(seconds * rate + 1e-6) + 1;
  if (count > static_cast<double>(kMostFrames))
    throw Error("the clip would have too many frames", std::to_string(rate) + " frames per second",
                "choose a lower rate");
  Motion out = motion;
  if (motion.frame_count == 0) return out;
  out.frame_time = 1 / rate;
  out.frame_count = static_cast<int>(count);
  out.values.assign(static_cast<std::size_t>(out.frame_count) * motion.channel_count, 0.0f);
  for (int frame = 0; frame < out.frame_count; ++frame) {
    if (frame % kFramesAtOnce == 0) progress.update("frames", double(frame) / out.frame_count);
    const double place = std::min(frame / rate / motion.frame_time, static_cast<double>(motion.frame_count - 1));
    const int before = std::min(static_cast<int>(place + 1e-9), motion.frame_count - 1),
              after = std::min(before + 1, motion.frame_count - 1);
    const double share = std::clamp(place - before, 0.0, 1.0);
    const float* low = motion.values.data() + static_cast<std::size_t>(before) * motion.channel_count;
    const float* high = motion.values.data() + static_cast<std::size_t>(after) * motion.channel_count;
    float* row = out.values.data() + static_cast<std::size_t>(frame) * motion.channel_count;
    if (share == 0) std::copy_n(low, motion.channel_count, row);
    else
      for (const BvhJoint& joint : motion.joints) mix_joint(joint, low, high, share, row);
  }
  return out;
}

Motion motion_of_poses(const Armature& armature, int frames, double rate, const std::function<Pose(int)>& pose_at) {
  Motion motion = motion_of(armature);
  motion.frame_count = std::max(0, frames);
  motion.frame_time = 1 / rate;
  motion.values.assign(static_cast<std::size_t>(motion.frame_count) * motion.channel_count, 0.0f);
  std::vector<int> bone_of(motion.joints.size());
  for (std::size_t j = 0; j < bone_of.size(); ++j) bone_of[j] = require_bone(armature, motion.joints[j].name);
  std::vector<glm::dvec3> near(motion.joints.size(), glm::dvec3(0));
  std::vector<glm::dquat> wanted(motion.joints.size()), written(motion.joints.size());
  for (int frame = 0; frame < motion.frame_count; ++frame) {
    const Pose pose = pose_at(frame);
    const std::vector<RigidTransform> posed = posed_from_rest(armature, pose);
    float* row = motion.values.data() + static_cast<std::size_t>(frame) * motion.channel_count;
    for (std::size_t j = 0; j < motion.joints.size(); ++j) {
      const BvhJoint& joint = motion.joints[j];
      const glm::dquat& turn = posed[bone_of[j]].rotation;
      wanted[j] = {turn.w, turn.x, turn.z, -turn.y};  // rotation of the bone in the world, in BVH axes
      // A joint's rotation is computed relative to the rounded rotation that the file holds for its parent, so that
      // rounding errors do not add up from joint to joint.
      const glm::dquat above = joint.parent < 0 ? glm::dquat(1, 0, 0, 0) : written[joint.parent];
      const auto order = *euler_order(joint);
      near[j] = euler_angles(glm::normalize(glm::conjugate(above) * wanted[j]), order, near[j]);
      put_rotation(joint, near[j], row);
      written[j] = above * rotation_of(order, rotation_values(joint, row));
      if (joint.parent >= 0) continue;
      const glm::dvec3 place = joint.offset + bvh_from_lps(pose.root_translation);
      for (std::size_t c = 0; c < joint.channels.size(); ++c)
        if (!is_rotation(joint.channels[c]))
          row[joint.first_channel + c] = static_cast<float>(place[axis_of(joint.channels[c])]);
    }
  }
  return motion;
}

}  // namespace limber
