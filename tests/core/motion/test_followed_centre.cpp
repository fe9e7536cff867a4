// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares the point that a camera follows with a walk whose positions are known by formula.
#include "core/motion/followed_centre.h"

#include <cmath>

#include <doctest/doctest.h>

#include "core/motion/recorded_clip.h"
#include "tests/support/sliding_walker.h"

using namespace limber;

namespace {

constexpr int kFrames = 240;
constexpr double kRate = 60, kSpeed = 20, kBounce = 30;  // frames per s; mm per frame forwards; mm up and down

// Returns the position in a straight walk at constant speed that bounces twice a second.
glm::dvec3 place_at(int frame) {
  return {0, -kSpeed * frame, kBounce * std::sin(frame / kRate * 2 * 2 * 3.14159265358979)};
}

std::shared_ptr<const Clip> bouncing_walk(const Armature& rig) {
  std::vector<Pose> poses(kFrames, rest_pose(rig));
  for (int frame = 0; frame < kFrames; ++frame) poses[frame].root_translation = place_at(frame);
  return std::make_shared<const Clip>(clip_of_poses({.name = "walk", .rate = kRate}, rig, poses, 0));
}

}  // namespace

TEST_CASE("followed centre: a camera keeps up with an even walk, and takes up little of its bounce") {
  const auto rig = std::make_shared<const Armature>(test::walker());
  FollowedCentre centre(bouncing_walk(*rig), rig);
  const glm::dvec3 start = centre.at(0);
  for (int frame = 0; frame < kFrames; ++frame) {
    CAPTURE(frame);
    const glm::dvec3 gone = centre.at(frame) - start;
    CHECK(std::abs(gone.y + kSpeed * frame) < 0.1);
    // Near the ends there are too few frames to average the bounce away.
    CHECK(std::abs(gone.z) < (frame > 45 && frame < kFrames - 45 ? 0.1 : 1.0) * kBounce);
  }
  CHECK(centre.at(-100) == start);
  CHECK(glm::distance(centre.at(1'000'000), centre.at(kFrames - 1)) == 0);
}
