// SPDX-License-Identifier: AGPL-3.0-or-later
// A clip for the small limb: its lower bone bends by one degree per frame.
#pragma once

#include <algorithm>

#include "core/motion/clip.h"
#include "editor/motion/timeline.h"
#include "tests/editor/small_limb.h"

namespace limber::test {

inline Motion bending_motion(const Armature& armature, int frames = 61, double rate = 30) {
  Motion motion = motion_of(armature);
  motion.frame_count = frames;
  motion.frame_time = 1 / rate;
  motion.values.assign(static_cast<std::size_t>(frames) * motion.channel_count, 0.0f);
  const BvhJoint& root = motion.joints[0];
  const BvhJoint& fore = motion.joints[1];
  const auto column = [](const BvhJoint& joint, BvhChannel channel) {
    return joint.first_channel +
           static_cast<int>(std::find(joint.channels.begin(), joint.channels.end(), channel) - joint.channels.begin());
  };
  for (int frame = 0; frame < frames; ++frame) {
    float* row = &motion.values[static_cast<std::size_t>(frame) * motion.channel_count];
    for (int axis = 0; axis < 3; ++axis)
      if (const int at = column(root, static_cast<BvhChannel>(axis));
          at < root.first_channel + std::ssize(root.channels))
        row[at] = static_cast<float>(root.offset[axis]);
    row[column(fore, BvhChannel::Xrotation)] = static_cast<float>(frame);
  }
  return motion;
}

// Returns the angle by which the lower bone is bent, degrees.
inline double bend_of(const Pose& pose) { return glm::degrees(2 * std::atan2(pose.rotation[1].x, pose.rotation[1].w)); }

// Returns the document of small_limb() with a clip in which the lower bone bends by one degree per frame.
inline Document bending_limb(int frames = 61, double rate = 30) {
  Document document = small_limb();
  editor::add_clip(
      document, clip_of(std::make_shared<const Motion>(bending_motion(*document.armature, frames, rate)), "bending"));
  return document;
}

}  // namespace limber::test
