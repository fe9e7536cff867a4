// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <map>

#include <glm/gtc/quaternion.hpp>

#include "core/phantom/limbs.h"

namespace limber::phantom {

namespace {
// Converts a vector from LPS axes (z up) to BVH axes (y up).
glm::dvec3 bvh_from_lps(const glm::dvec3& p) { return {p.x, p.z, -p.y}; }

// Returns the Euler angles z, x, y, in degrees, of a rotation R = Rz Rx Ry.
glm::dvec3 zxy_degrees(const glm::dmat3& r) {
  const double x = std::asin(std::clamp(r[1][2], -1.0, 1.0));
  const double z = std::atan2(-r[1][0], r[1][1]), y = std::atan2(-r[0][2], r[2][2]);
  return glm::degrees(glm::dvec3(z, x, y));
}
}  // namespace

Motion make_motion(const Armature& armature, const std::vector<MotionFrame>& frames, double frame_time) {
  using C = BvhChannel;
  Motion motion;
  std::map<std::string, int> joint_of;
  std::vector<bool> has_child(armature.bones.size(), false);
  for (const Bone& bone : armature.bones)
    if (bone.parent >= 0) has_child[bone.parent] = true;
  for (std::size_t i = 0; i < armature.bones.size(); ++i) {
    const Bone& bone = armature.bones[i];
    BvhJoint joint;
    joint.name = bone.name;
    joint.parent = bone.parent;
    joint.first_channel = motion.channel_count;
    joint.offset = bvh_from_lps(bone.parent < 0 ? bone.head : bone.head - armature.bones[bone.parent].head);
    if (bone.parent < 0) joint.channels = {C::Xposition, C::Yposition, C::Zposition};
    joint.channels.insert(joint.channels.end(), {C::Zrotation, C::Xrotation, C::Yrotation});
    if (!has_child[i]) joint.end_site = bvh_from_lps(bone.tail - bone.head);
    motion.channel_count += static_cast<int>(joint.channels.size());
    joint_of[bone.name] = static_cast<int>(i);
    motion.joints.push_back(std::move(joint));
  }

  motion.frame_count = static_cast<int>(frames.size());
  motion.frame_time = frame_time;
  motion.values.assign(frames.size() * motion.channel_count, 0.0f);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    float* row = motion.values.data() + f * motion.channel_count;
    std::vector<glm::dquat> turn(motion.joints.size(), glm::dquat(1, 0, 0, 0));
    for (const Turn& t : frames[f].turns) {
      glm::dquat& q = turn[joint_of.at(t.bone)];
      q = glm::angleAxis(glm::radians(t.degrees), glm::normalize(bvh_from_lps(t.axis))) * q;
    }
    for (std::size_t j = 0; j < motion.joints.size(); ++j) {
      const BvhJoint& joint = motion.joints[j];
      float* value = row + joint.first_channel;
      if (joint.parent < 0) {
        const glm::dvec3 place = joint.offset + bvh_from_lps(frames[f].root_offset);
        for (int axis = 0; axis < 3; ++axis) *value++ = static_cast<float>(place[axis]);
      }
      const glm::dvec3 angles = zxy_degrees(glm::mat3_cast(turn[j]));
      for (int axis = 0; axis < 3; ++axis) *value++ = static_cast<float>(angles[axis]);
    }
  }
  return motion;
}

}  // namespace limber::phantom
