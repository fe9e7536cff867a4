// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/phantom/phantom.h"

#include <cmath>
#include <numbers>

#include "core/phantom/limbs.h"

namespace limber {

namespace {
using namespace phantom;

constexpr int kFrames = 60;
constexpr double kFrameTime = 1.0 / 30;
constexpr double kArmBend = 25;  // elbow's bend at rest, degrees; it lets the bones' directions show the elbow's axis
// Angles of a relaxed A-pose, degrees. They keep the limbs from touching each other and the trunk.
constexpr double kArmSpread = 38, kBodyElbowBend = 14, kLegSpread = 6, kKneeBend = 4;

double thinnest(double spacing) { return 0.6 * spacing; }

// Returns a value that rises smoothly from 0 at the first frame to 1 in the middle and falls to 0 at the last frame.
double there_and_back(int frame) { return 0.5 - 0.5 * std::cos(2 * std::numbers::pi * frame / (kFrames - 1)); }

Motion arm_curl(const Armature& armature) {
  std::vector<MotionFrame> frames(kFrames);
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

// Returns a motion of one stride (two steps). The right leg is half a cycle behind the left one, and each arm swings
// opposite to the leg of its side.
Motion walk(const Armature& armature) {
  constexpr double kStride = 1300;  // length of a stride, mm
  // Rotation axes: a hanging limb swings forward about the first, and the body turns left about the second.
  const glm::dvec3 forward(-1, 0, 0), up(0, 0, 1);
  const auto bump = [](double phase, double centre, double width) {
    const double d = std::remainder(phase - centre, 1.0) / width;
    return std::exp(-d * d);
  };
  const auto axis_of = [&](const std::string& bone) {
    return armature.bones[require_bone(armature, bone)].limits.axis;
  };
  std::vector<MotionFrame> frames(kFrames);
  for (int f = 0; f < kFrames; ++f) {
    auto& [turns, offset] = frames[f];
    const double cycle = static_cast<double>(f) / kFrames;
    offset = {0, -kStride * cycle, -12 + 12 * std::cos(4 * std::numbers::pi * cycle)};
    for (const double side : {1.0, -1.0}) {
      const std::string name = side > 0 ? "Left" : "Right";
      const double phase = cycle + (side > 0 ? 0 : 0.5),
                   swing = std::cos(2 * std::numbers::pi * phase);  // 1 at phase 0, when the heel meets the ground
      // The angles of hip, knee and ankle are close to those of gait analysis [Winter 1991].
      turns.push_back({name + "Thigh", forward, 6 + 23 * swing});
      turns.push_back(
          {name + "Shank", axis_of(name + "Shank"), 14 * bump(phase, 0.14, 0.09) + 56 * bump(phase, 0.73, 0.12)});
      turns.push_back({name + "Foot", forward, 8 * bump(phase, 0.42, 0.14) - 18 * bump(phase, 0.63, 0.07)});
      turns.push_back({name + "Toes", forward, 25 * bump(phase, 0.56, 0.08)});
      turns.push_back({name + "UpperArm", {0, side, 0}, kArmSpread - 12});
      turns.push_back({name + "UpperArm", forward, 4 - 20 * swing});
      turns.push_back({name + "Forearm", axis_of(name + "Forearm"), 10 - 10 * swing});
    }
    const double twist = std::cos(2 * std::numbers::pi * cycle);
    turns.push_back({"Hips", up, -4 * twist});
    turns.push_back({"Spine", up, 5 * twist});
    turns.push_back({"Chest", up, 4 * twist});
    turns.push_back({"Neck", up, -5 * twist});
  }
  return make_motion(armature, frames, kFrameTime);
}
}  // namespace

phantom::Anatomy phantom::arm_anatomy(double thinnest_radius) {
  Anatomy anatomy;
  // add_arm() builds a left arm, which becomes a right arm when it is mirrored.
  add_arm(anatomy, {.root = Frame{}.mirrored_x(), .bend_degrees = kArmBend, .thinnest_radius = thinnest_radius});
  return anatomy;
}

phantom::Anatomy phantom::body_anatomy(double thinnest_radius) {
  Anatomy anatomy;
  const TrunkJoints joints = add_trunk(anatomy, thinnest_radius);
  for (const bool left : {true, false}) {
    const auto placed = [&](const Frame& frame) { return left ? frame : frame.mirrored_x(); };
    const std::string name = left ? "Left" : "Right";
    add_arm(anatomy, {.root = placed(Frame{joints.left_shoulder, glm::dmat3(1)}.turned({0, 1, 0}, -kArmSpread)),
                      .prefix = name,
                      .flesh_parent = joints.flesh,
                      .rig_parent = require_bone(anatomy.armature, name + "Clavicle"),
                      .bend_degrees = kBodyElbowBend,
                      .thinnest_radius = thinnest_radius});
    add_leg(anatomy,
            {.root = placed(Frame{joints.left_hip, glm::dmat3(1)}.turned({0, 1, 0}, -kLegSpread)),
             .prefix = name,
             .flesh_parent = joints.flesh,
             .rig_parent = joints.hips_bone,
             .bend_degrees = kKneeBend,
             .thinnest_radius = thinnest_radius},
            placed(Frame{}));
  }
  return anatomy;
}

Phantom make_arm_phantom(double spacing, Progress& progress) {
  const Anatomy anatomy = arm_anatomy(thinnest(spacing));
  Phantom result{voxelize(anatomy, spacing, progress), {}, anatomy.armature, arm_curl(anatomy.armature)};
  result.tissues = phantom_tissues(result.volume);
  return result;
}

Phantom make_body_phantom(double spacing, Progress& progress) {
  const Anatomy anatomy = body_anatomy(thinnest(spacing));
  Phantom result{voxelize(anatomy, spacing, progress), {}, anatomy.armature, walk(anatomy.armature)};
  result.tissues = phantom_tissues(result.volume);
  return result;
}

}  // namespace limber
