// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/motion_edit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"

namespace limber::test {

namespace {

glm::dquat random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
}

glm::dquat about(int axis, double angle) {
  glm::dvec3 unit(0);
  unit[axis] = 1;
  return glm::angleAxis(angle, unit);
}

// Returns the largest distance between the same joint in two motions, over all frames of `a`.
//   frame_of_b  returns the frame of `b` that is compared with a frame of `a`
double farthest(const Motion& a, const Motion& b, const std::function<int(int)>& frame_of_b) {
  double most = 0;
  for (int frame = 0; frame < a.frame_count; ++frame) {
    const auto p = forward_kinematics(a, frame), q = forward_kinematics(b, frame_of_b(frame));
    for (std::size_t j = 0; j < p.size(); ++j) most = std::max(most, glm::distance(p[j].translation, q[j].translation));
  }
  return most;
}

// Makes a smoothly moving chain whose joints use every order of rotation channels.
Motion swaying(int frames, double rate) {
  using enum BvhChannel;
  Motion motion;
  motion.joints = {{.name = "Root", .channels = {Xposition, Yposition, Zposition, Zrotation, Xrotation, Yrotation}},
                   {.name = "A",
                    .parent = 0,
                    .offset = {1, 5, 0},
                    .channels = {Xrotation, Yrotation, Zrotation},
                    .first_channel = 6},
                   {.name = "B",
                    .parent = 1,
                    .offset = {0, 7, 1},
                    .channels = {Yrotation, Zrotation, Xrotation},
                    .first_channel = 9},
                   {.name = "C",
                    .parent = 2,
                    .offset = {2, 3, 0},
                    .channels = {Yrotation},
                    .first_channel = 12,
                    .end_site = glm::dvec3(0, 4, 0)}};
  motion.channel_count = 13;
  motion.frame_count = frames;
  motion.frame_time = 1 / rate;
  for (int frame = 0; frame < frames; ++frame)
    for (int c = 0; c < 13; ++c)
      motion.values.push_back(static_cast<float>(40 * std::sin(frame / rate * (1 + 0.2 * c) + c)));
  return motion;
}

}  // namespace

TEST_CASE("euler angles: every rotation in every order comes back, near the angles asked for, at right angles too") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-20, 20);
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int i = 0; i < 200; ++i) {
      const double middle = i % 3 == 0 ? std::numbers::pi / 2 : i % 3 == 1 ? -std::numbers::pi / 2 : any(random);
      const glm::dquat rotation =
          i % 2 ? random_rotation(random)
                : glm::normalize(about(order[0], any(random)) * about(order[1], middle) * about(order[2], any(random)));
      const glm::dvec3 near(any(random), any(random), any(random));
      const glm::dvec3 angles = euler_angles(rotation, order, near);
      const glm::dquat back = about(order[0], angles[0]) * about(order[1], angles[1]) * about(order[2], angles[2]);
      CHECK(std::abs(glm::dot(back, rotation)) > 1 - 1e-12);
      for (int a = 0; a < 3; ++a) CHECK(std::abs(angles[a] - near[a]) <= 2 * std::numbers::pi);
      // If euler_angles() gets as its hint the angles from which a rotation was made, it returns these angles.
      const glm::dvec3 own(0.3, middle > 1.5 || middle < -1.5 ? 0.2 : middle, -2.0);
      const glm::dquat made = about(order[0], own[0]) * about(order[1], own[1]) * about(order[2], own[2]);
      CHECK(glm::distance(euler_angles(made, order, own), own) < 1e-9);
    }
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST_CASE("resampled: at its own rate a motion stays as it is, at twice the rate every second frame does") {
  const Motion motion = swaying(50, 30);
  CHECK(resampled(motion, 30).values == motion.values);
  const Motion doubled = resampled(motion, 60);
  CHECK(doubled.frame_count == 99);
  CHECK(farthest(motion, doubled, [](int frame) { return 2 * frame; }) < 1e-4);
  // Between the original frames, joints are where the exact motion has them, up to the second order in the step.
  const Motion fine = swaying(99, 60);
  CHECK(farthest(fine, doubled, [](int frame) { return frame; }) < 0.1);
}

TEST_CASE("resampled: an angle that goes over 180 degrees does not swing back") {
  Motion motion;
  motion.joints = {{.name = "Root", .channels = {BvhChannel::Yrotation}, .end_site = glm::dvec3(1, 0, 0)}};
  motion.channel_count = 1;
  motion.frame_count = 2;
  motion.frame_time = 1;
  motion.values = {175, -175};
  CHECK(std::abs(resampled(motion, 2).values[1]) == doctest::Approx(180));
  CHECK_THROWS_AS(resampled(motion, 0), Error);
  CHECK_THROWS_AS(resampled(motion, std::nan("")), Error);
}

TEST_CASE("z up: every joint stands where the turned file has it") {
  const Motion motion = swaying(20, 30);
  const Motion up = y_up_from_z_up(motion);
  for (int frame = -1; frame < motion.frame_count; ++frame) {
    const auto before = forward_kinematics(motion, frame), after = forward_kinematics(up, frame);
    for (std::size_t j = 0; j < before.size(); ++j) {
      const glm::dvec3& p = before[j].translation;
      CHECK(glm::distance(after[j].translation, glm::dvec3(p.x, p.z, -p.y)) < 1e-9);
    }
  }
}

TEST_CASE("motion of poses: written and read again, every joint stands within 1e-4 mm of the posed rig") {
  std::mt19937 random(11);
  Armature armature;
  for (int b = 0; b < 8; ++b) {
    const glm::dvec3 head(20 * b, 5 * std::sin(b), -300 + 100 * b);
    armature.bones.push_back({"Bone " + std::to_string(b), b == 5 ? 2 : b - 1, head, head + glm::dvec3(10, 5, 90)});
  }
  std::vector<Pose> poses;
  for (int frame = 0; frame < 20; ++frame) {
    Pose pose = rest_pose(armature);
    for (glm::dquat& rotation : pose.rotation) rotation = random_rotation(random);
    pose.root_translation = {10 * frame, -3.5 * frame, 1};
    poses.push_back(pose);
  }
  const Motion motion = motion_of_poses(armature, 20, 120, [&](int frame) { return poses[frame]; });
  const Motion back = parse_bvh(bvh_text(motion), "again.bvh");
  CHECK(back.frame_count == 20);
  CHECK(back.frame_time == doctest::Approx(1.0 / 120));
  for (int frame = 0; frame < 20; ++frame) {
    const auto posed = posed_from_rest(armature, poses[frame]);
    const auto joints = forward_kinematics(back, frame);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const int bone = require_bone(armature, back.joints[j].name);
      CHECK(glm::distance(lps_from_bvh(joints[j].translation), posed[bone] * armature.bones[bone].head) < 1e-4);
    }
  }
}

}  // namespace limber::test
