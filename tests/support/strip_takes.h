// SPDX-License-Identifier: AGPL-3.0-or-later
// Random motions ("takes") of a small body, and tracks with a strip that plays such a motion, for tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/motion/motion_edit.h"
#include "core/motion/strip_edits.h"
#include "core/motion/strips_on_rig.h"
#include "tests/support/sliding_walker.h"

namespace limber::test {

using SharedClip = std::shared_ptr<const Clip>;
using Rig = std::shared_ptr<const Armature>;

inline Rig rig() {
  static const Rig kRig = std::make_shared<const Armature>(walker());
  return kRig;
}

// Returns a motion in which every bone turns in its own way, and the body travels and turns.
inline SharedClip take(const std::string& name, int frames, int seed, double rate = 30) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<glm::dvec3> axes;
  for (std::size_t bone = 0; bone < rig()->bones.size(); ++bone)
    axes.emplace_back(any(random), any(random), any(random));
  const auto pose_at = [&](int frame) {
    Pose pose = rest_pose(*rig());
    for (std::size_t bone = 0; bone < axes.size(); ++bone) {
      const glm::dvec3 turn = std::sin(0.07 * frame + static_cast<double>(bone) + 0.5) * axes[bone];
      pose.rotation[bone] = glm::angleAxis(glm::length(turn), glm::normalize(turn));
    }
    pose.root_translation = {5.0 * seed * frame, -20.0 * frame, 10 * std::sin(0.3 * frame)};
    return pose;
  };
  Clip clip = clip_of(std::make_shared<const Motion>(motion_of_poses(*rig(), frames, rate, pose_at)), name);
  clip.retarget.travel = Travel::Free;
  return std::make_shared<const Clip>(clip);
}

inline Strips one_strip(const SharedClip& clip, int start) {
  Strips strips;
  strips.tracks.push_back({.name = "Track", .strips = {strip_of(clip, {}, start)}});
  return strips;
}
inline Strip& only(Strips& strips) { return strips.tracks[0].strips[0]; }

inline Pose at(const Strips& strips, int frame, double rate = 30) {
  return StripsOnRig(std::make_shared<const Strips>(strips), rig(), rate).at(frame);
}
inline Pose at(const SharedClip& clip, int frame) { return ClipOnRig(clip, rig()).at(frame); }

// Returns how far two poses differ: the distance of their roots, mm, or the largest angle between their bones'
// rotations, radians, whichever number is larger.
inline double far(const Pose& a, const Pose& b) {
  double most = glm::distance(a.root_translation, b.root_translation);
  for (std::size_t bone = 0; bone < a.rotation.size(); ++bone) {
    const glm::dquat between = glm::conjugate(a.rotation[bone]) * b.rotation[bone];
    most = std::max(most, 2 * std::hypot(between.x, between.y, between.z));
  }
  return most;
}

}  // namespace limber::test
