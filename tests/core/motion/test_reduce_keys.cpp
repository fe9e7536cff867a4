// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/reduce_keys.h"

#include <atomic>

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "core/motion/clip.h"
#include "core/motion/key_curve.h"

namespace limber::test {

namespace {

Armature arm() {
  Armature armature;
  armature.bones = {{"Upper", -1, {0, 0, 30}, {0, 0, 0}},
                    {"Fore", 0, {0, 0, 0}, {0, 0, -30}},
                    {"Still", 1, {0, 0, -30}, {0, 0, -40}},
                    {"Bent", 2, {0, 0, -40}, {0, 0, -50}}};
  return armature;
}

glm::dquat turned(const glm::dvec3& v) {
  const double angle = glm::length(v);
  return angle == 0 ? glm::dquat(1, 0, 0, 0) : glm::angleAxis(angle, v / angle);
}

// Returns poses in which the upper arm swings, the forearm waves about a changing axis, and the body moves.
std::vector<Pose> recorded(int frames) {
  const Armature armature = arm();
  std::vector<Pose> poses;
  for (int frame = 0; frame < frames; ++frame) {
    Pose pose = rest_pose(armature);
    const double t = frame / 30.0;
    pose.rotation[0] = turned({0.6 * std::sin(2 * t), 0, 0.1});
    pose.rotation[1] = turned({0.5 * std::sin(3 * t), 0.4 * std::cos(2.3 * t), 0.3 * t});
    pose.rotation[3] = turned({0.4, 0, 0});
    pose.root_translation = {100 * t, 20 * std::sin(6 * t), 0};
    poses.push_back(pose);
  }
  return poses;
}

// Returns the angle between two rotations in degrees, from their matrices.
double degrees_apart(const glm::dquat& a, const glm::dquat& b) {
  const glm::dmat3 turn = glm::mat3_cast(a) * glm::transpose(glm::mat3_cast(b));
  const glm::dvec3 axis(turn[1][2] - turn[2][1], turn[2][0] - turn[0][2], turn[0][1] - turn[1][0]);
  return glm::degrees(std::atan2(glm::length(axis), turn[0][0] + turn[1][1] + turn[2][2] - 1));
}

// Reports a cancel after `times` queries.
class CancelledLater final : public Progress {
 public:
  explicit CancelledLater(int times) : left_(times) {}
  bool cancelled() const override { return --left_ < 0; }

 private:
  mutable std::atomic<int> left_;
};

}  // namespace

TEST_CASE("reducing keys: a cancel takes effect within a bone, while its keys are inserted and while they go") {
  Armature armature = arm();
  armature.bones.resize(1);
  std::vector<Pose> poses;
  for (Pose pose : recorded(241)) {
    pose.rotation.resize(1);
    pose.root_translation = {0, 0, 0};
    poses.push_back(pose);
  }
  for (const int times : {2, 200}) {
    CancelledLater progress(times);
    CHECK_THROWS_AS(reduced_to_keys(armature, poses, 0, {.degrees = 0.05, .mm = 1}, progress), Cancelled);
  }
}

TEST_CASE("reducing keys: every played frame stays within the error, with far fewer keys than frames") {
  const Armature armature = arm();
  const std::vector<Pose> poses = recorded(241);
  std::int64_t keys_before = 1'000'000;
  for (const double degrees : {0.05, 0.5, 3.0}) {
    const ReducedKeys reduced = reduced_to_keys(armature, poses, 100, {.degrees = degrees, .mm = 1}, no_progress());
    Clip clip{.name = "keys"};
    clip.keys = reduced.keys;
    const ClipOnRig played(std::make_shared<const Clip>(clip), std::make_shared<const Armature>(armature));
    double most = 0, most_mm = 0;
    for (int frame = 0; frame < 241; ++frame) {
      const Pose pose = played.at(100 + frame);
      for (int bone = 0; bone < 4; ++bone)
        most = std::max(most, degrees_apart(pose.rotation[bone], poses[frame].rotation[bone]));
      most_mm = std::max(most_mm, glm::distance(pose.root_translation, poses[frame].root_translation));
    }
    CHECK(most <= degrees + 1e-6);
    CHECK(std::abs(most - reduced.most_degrees) < 1e-6);
    CHECK(most_mm <= 1);
    CHECK(std::abs(most_mm - reduced.most_mm) < 1e-9);
    CHECK(reduced.count < keys_before);
    keys_before = reduced.count;
    if (degrees == 0.5) {
      CHECK(reduced.keys.bones.at("Upper").size() < 20);
      CHECK(reduced.keys.bones.at("Fore").size() < 25);
    }
    CHECK(!reduced.keys.bones.contains("Still"));
    CHECK(reduced.keys.bones.at("Bent").size() == 1);
  }
}

TEST_CASE("reducing keys: a curve of few keys is found again with no more of them") {
  const Armature armature = arm();
  std::map<int, glm::dquat> keys;
  KeyShapes shapes;
  const std::pair<int, glm::dvec3> made[] = {
      {0, {0, 0, 0}}, {23, {0.5, 0.2, 0}}, {50, {0.1, -0.4, 0.3}}, {61, {0.3, 0, 0.2}}, {100, {-0.6, 0.3, 0}}};
  for (const auto& [frame, v] : made) {
    keys[frame] = turned(v);
    shapes[frame] = {Interpolation::Bezier, HandleKind::Automatic};
  }
  std::vector<Pose> poses;
  for (int frame = 0; frame <= 100; ++frame) {
    poses.push_back(rest_pose(armature));
    poses.back().rotation[1] = value_at(keys, shapes, frame);
  }
  const ReducedKeys reduced = reduced_to_keys(armature, poses, 0, {.degrees = 0.05}, no_progress());
  CHECK(reduced.keys.bones.at("Fore").size() <= 7);
  CHECK(reduced.most_degrees <= 0.05);
  CHECK(reduced.worst_bone == "Fore");
}

TEST_CASE("reducing keys: frames that are kept closely cost no keys far from them") {
  const Armature armature = arm();
  std::vector<Pose> poses = recorded(361);
  for (int frame = 0; frame < 361; ++frame)  // a tremor, which differences between frames exaggerate
    poses[frame].rotation[0] = turned({0.6 * std::sin(frame / 15.0) + 0.004 * std::sin(frame * 2.1), 0, 0.1});
  AllowedErrors allowed = allowed_everywhere(armature, poses.size(), {.degrees = 0.5, .mm = 1});
  const auto keys_from = [&](int frame) {
    const ReducedKeys reduced = KeyFitter(armature, poses, 0).fitted(allowed, no_progress());
    const auto& keys = reduced.keys.bones.at("Upper");
    return std::distance(keys.lower_bound(frame), keys.end());
  };
  const auto before = keys_from(60);
  for (int frame = 0; frame < 20; ++frame) allowed.degrees[0][frame] = 1e-3;
  CHECK(keys_from(60) <= before + 1);
}

TEST_CASE("reducing keys: fitting again gives what fitting once gives, without another look at bones that stay") {
  const Armature armature = arm();
  const std::vector<Pose> poses = recorded(241);
  AllowedErrors allowed = allowed_everywhere(armature, poses.size(), {});
  KeyFitter fitter(armature, poses, 0);
  CHECK(fitter.fitted(allowed, no_progress()).keys == reduced_to_keys(armature, poses, 0, {}, no_progress()).keys);
  for (int frame = 30; frame < 60; ++frame) allowed.degrees[1][frame] = 0.01;
  CHECK(fitter.fitted(allowed, no_progress()).keys ==
        KeyFitter(armature, poses, 0).fitted(allowed, no_progress()).keys);
  // The fifth question whether to cancel is answered with yes. The fitter asks once for each of the four bones, and
  // more often only while it fits. So a run that fits nothing is not cancelled, and the next one is.
  CancelledLater progress(4);
  CHECK_NOTHROW(fitter.fitted(allowed, progress));
  allowed.mm[7] = 0.01;
  CHECK_THROWS_AS(fitter.fitted(allowed, progress), Cancelled);
}

TEST_CASE("reducing keys: one thread gives what two threads give, bit for bit") {
  const std::vector<Pose> poses = recorded(121);
  const auto by = [&](int threads) {
    const ThreadCount count(threads);
    return reduced_to_keys(arm(), poses, 0, {}, no_progress()).keys;
  };
  CHECK(by(1) == by(2));
}

TEST_CASE("reducing keys: no frames, one frame and no error allowed") {
  CHECK(reduced_to_keys(arm(), {}, 0, {}, no_progress()).keys.empty());
  const ReducedKeys one = reduced_to_keys(arm(), {recorded(10)[7]}, 7, {}, no_progress());
  CHECK(one.keys.bones.at("Fore").size() == 1);
  CHECK(one.most_degrees == 0);
  CHECK_THROWS_AS(reduced_to_keys(arm(), recorded(3), 0, {.degrees = 0}, no_progress()), Error);
}

}  // namespace limber::test
