// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/loop_poses.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/motion/ground_move.h"
#include "core/motion/key_curve.h"
#include "tests/support/sliding_walker.h"

namespace limber::test {

namespace {

constexpr double kTau = 2 * std::numbers::pi;

// Makes one cycle of a walk along a circle that does not quite close: at its end all bones but the root are turned by
// `open` radians more than at its start, and the body is 30 mm times `open` lower.
std::vector<Pose> circling(const Armature& rig, int frames, double open) {
  std::vector<Pose> poses;
  for (int f = 0; f < frames; ++f) {
    const double share = double(f) / (frames - 1), phase = kTau * share, turn = 0.8 * share;
    Pose pose = rest_pose(rig);
    for (std::size_t b = 1; b < pose.rotation.size(); ++b)
      pose.rotation[b] = glm::angleAxis(0.5 * std::sin(phase + double(b)) + open * share,
                                        glm::normalize(glm::dvec3(1, 0.2 * double(b % 3), 0.1)));
    pose.rotation[0] =
        glm::angleAxis(turn, glm::dvec3(0, 0, 1)) * glm::angleAxis(0.1 * std::sin(phase), glm::dvec3(1, 0, 0));
    pose.root_translation = {1000 - 1000 * std::cos(turn), -1000 * std::sin(turn),
                             20 * std::sin(2 * phase) - 30 * open * share};
    poses.push_back(pose);
  }
  return poses;
}

std::vector<glm::dvec3> heads(const Armature& rig, const Pose& pose) {
  const auto posed = posed_from_rest(rig, pose);
  std::vector<glm::dvec3> places;
  for (std::size_t b = 0; b < posed.size(); ++b) places.push_back(posed[b] * rig.bones[b].tail);
  return places;
}

double turn_of_step(const std::vector<Pose>& poses, int frame, std::size_t bone) {
  return glm::length(turn_between(poses[frame].rotation[bone], poses[frame + 1].rotation[bone]));
}

}  // namespace

TEST_CASE("looped poses: travel and heading go on from repeat to repeat") {
  const Armature rig = walker();
  const std::vector<Pose> take = circling(rig, 61, 0);
  const LoopedPoses loop = looped(rig, take, {.repeats = 5, .blend = 20});
  REQUIRE(loop.poses.size() == 5 * 60 + 1);
  CHECK(loop.gap_degrees < 1e-6);
  // The circle continues, so position and heading after any frame are known.
  for (int f = 0; f <= 300; ++f) {
    const double turn = 0.8 * f / 60, phase = kTau * f / 60;
    const Pose& pose = loop.poses[f];
    const glm::dquat wanted =
        glm::angleAxis(turn, glm::dvec3(0, 0, 1)) * glm::angleAxis(0.1 * std::sin(phase), glm::dvec3(1, 0, 0));
    CHECK(glm::length(turn_between(pose.rotation[0], wanted)) < 2e-3);
    CHECK(glm::distance(pose.root_translation, glm::dvec3(1000 - 1000 * std::cos(turn), -1000 * std::sin(turn),
                                                          20 * std::sin(2 * phase))) < 0.5);
  }
}

TEST_CASE("looped poses: both sides of a seam meet with one speed, and nothing is hasty") {
  const Armature rig = walker();
  for (const bool stays : {false, true}) {
    const std::vector<Pose> take = circling(rig, 61, 0.15);
    const int blend = 30;
    const LoopedPoses loop = looped(rig, take, {.repeats = 3, .blend = blend, .stays = stays});
    CHECK(loop.gap_degrees > 8);
    CHECK(loop.haste < 1.5);
    for (const int seam : {60, 120})
      for (std::size_t b = 0; b < rig.bones.size(); ++b) {
        CAPTURE(rig.bones[b].name);
        // At the seam, a bone's rotation per frame changes by less than 0.01 radians.
        const double before = turn_of_step(loop.poses, seam - 1, b), after = turn_of_step(loop.poses, seam, b);
        CHECK(std::abs(after - before) < 0.01);
        double fastest = 0, was = 0;
        for (int f = seam - blend / 2; f < seam + blend / 2; ++f)
          fastest = std::max(fastest, turn_of_step(loop.poses, f, b));
        for (int f = 0; f < blend / 2; ++f)
          was = std::max({was, turn_of_step(take, f, b), turn_of_step(take, 59 - f, b)});
        CHECK(fastest < 1.5 * was + 1e-3);
      }
    // Joint positions in the world have no jump in speed either.
    for (int f = 1; f + 1 < std::ssize(loop.poses); ++f) {
      const auto a = heads(rig, loop.poses[f - 1]), b = heads(rig, loop.poses[f]), c = heads(rig, loop.poses[f + 1]);
      for (std::size_t bone = 0; bone < a.size(); ++bone) CHECK(glm::length(a[bone] - 2.0 * b[bone] + c[bone]) < 25);
    }
    // Without a blend, the speed jumps at the seam.
    const LoopedPoses hard = looped(rig, take, {.repeats = 2, .blend = 0, .stays = stays});
    CHECK(hard.haste > 1.5);
  }
}

TEST_CASE("looped poses: on the spot the body comes back to its place and heading") {
  const Armature rig = walker();
  const LoopedPoses loop = looped(rig, circling(rig, 61, 0.1), {.repeats = 4, .blend = 20, .stays = true});
  for (int repeat = 1; repeat <= 4; ++repeat) {
    const Pose &first = loop.poses.front(), &last = loop.poses[60 * repeat];
    CHECK(glm::distance(first.root_translation, last.root_translation) < 1e-6);
    for (std::size_t b = 0; b < rig.bones.size(); ++b)
      CHECK(glm::length(turn_between(first.rotation[b], last.rotation[b])) < 1e-7);
  }
  // The travel along the circle, 780 mm per repeat, is removed. What remains is the distance of the arc from its chord.
  for (const Pose& pose : loop.poses) CHECK(std::hypot(pose.root_translation.x, pose.root_translation.y) < 82);
}

TEST_CASE("looped poses: what cannot be repeated is said") {
  Armature rig = walker();
  const std::vector<Pose> take = circling(rig, 21, 0);
  CHECK_THROWS_AS(looped(rig, {take[0], take[1]}, {}), Error);
  CHECK_THROWS_AS(looped(rig, take, {.repeats = 0}), Error);
  CHECK_THROWS_AS(looped(rig, take, {.repeats = 1'000'000}), Error);
  CHECK_THROWS_AS(looped(rig, take, {.blend = 21}), Error);
  CHECK_THROWS_AS(looped(rig, take, {.blend = -1}), Error);
  rig.bones[1].parent = -1;
  CHECK_THROWS_AS(looped(rig, take, {.repeats = 2}), Error);
}

}  // namespace limber::test
