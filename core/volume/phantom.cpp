// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/phantom.h"

#include <cmath>
#include <numbers>

#include "core/volume/phantom_limbs.h"

namespace limber {

namespace {
using namespace phantom;

constexpr int kFrames = 60;
constexpr double kFrameTime = 1.0 / 30;
constexpr double kArmBend = 25;  // degrees of the elbow at rest, so that its flex axis is defined by the bones alone

double thinnest(double spacing) { return 0.6 * spacing; }

// 0 at the first and last frame, 1 in between.
double there_and_back(int frame) { return 0.5 - 0.5 * std::cos(2 * std::numbers::pi * frame / (kFrames - 1)); }

Motion arm_curl(const Armature& armature) {
  std::vector<Frame60> frames(kFrames);
  for (int f = 0; f < kFrames; ++f) {
    const double s = there_and_back(f);
    for (const Bone& bone : armature.bones) {
      const bool digit = bone.limits.type == JointLimits::Type::Hinge && bone.name != "Forearm";
      if (bone.name == "Forearm") frames[f].turns.push_back({bone.name, bone.limits.axis, 100 * s});
      if (digit) frames[f].turns.push_back({bone.name, bone.limits.axis, s * glm::degrees(bone.limits.maximum) * 0.5});
    }
  }
  return make_motion(armature, frames, kFrameTime);
}
}  // namespace

Phantom make_arm_phantom(double spacing, Progress& progress) {
  Anatomy anatomy;
  // A right arm: the left one across x = 0.
  add_arm(anatomy, {.root = Frame{}.mirrored_x(), .bend_degrees = kArmBend, .thinnest_radius = thinnest(spacing)});
  Phantom result{voxelize(anatomy, spacing, progress), {}, anatomy.armature, arm_curl(anatomy.armature)};
  result.tissues = phantom_tissues(result.volume);
  return result;
}

}  // namespace limber
