// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/join_poses.h"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/motion/clean_motion.h"
#include "core/motion/ground_move.h"
#include "core/motion/key_curve.h"
#include "tests/support/sliding_walker.h"

namespace limber::test {

namespace {

constexpr double kRate = 60;

// Returns `count` poses of a walker whose standing feet do not slide, from frame `first` on, moved by `move`.
std::vector<Pose> steps(const Armature& rig, const GroundMove& move, int first, int count) {
  const std::vector<PlantedLimb> limbs = planted_limbs(rig);
  const auto clean = clean_motion(rig, limbs, sliding_steps(rig, 240), kRate, true, {}, 0.15).poses;
  std::vector<Pose> poses;
  for (int f = first; f < first + count; ++f) poses.push_back(moved(rig, clean[f], move));
  return poses;
}

}  // namespace

TEST_CASE("ground move: a body comes to the place and heading of another pose") {
  const Armature rig = walker();
  Pose pose = rest_pose(rig), wanted = pose;
  pose.root_translation = {10, 20, 30};
  pose.rotation[0] = glm::angleAxis(0.2, glm::dvec3(1, 0, 0));
  wanted.root_translation = {-500, 900, 80};
  wanted.rotation[0] = glm::angleAxis(2.5, glm::dvec3(0, 0, 1)) * pose.rotation[0];
  const GroundMove move = move_to(rig, pose, wanted);
  CHECK(move.turn == doctest::Approx(2.5));
  const Pose result = moved(rig, pose, move);
  CHECK(glm::distance(result.root_translation, glm::dvec3(-500, 900, 30)) < 1e-9);
  CHECK(glm::length(turn_between(result.rotation[0], wanted.rotation[0])) < 1e-9);
  // All joints have the same distances from each other as before the move.
  const auto before = posed_from_rest(rig, pose), after = posed_from_rest(rig, result);
  for (std::size_t b = 0; b < rig.bones.size(); ++b)
    CHECK(glm::distance(after[b] * rig.bones[b].tail, move.place(before[b] * rig.bones[b].tail)) < 1e-9);
}

TEST_CASE("joined poses: a take cut in two and turned aside comes together again") {
  const Armature rig = walker();
  const std::vector<PlantedLimb> limbs = planted_limbs(rig);
  const std::vector<Pose> whole = steps(rig, {}, 0, 200);
  const std::vector<Pose> first(whole.begin(), whole.begin() + 120);
  std::vector<Pose> second;
  for (int f = 100; f < 200; ++f) second.push_back(moved(rig, whole[f], {1.9, {3, 4, 0}, {7000, -900, 0}}));
  for (const bool keeps_feet : {false, true}) {
    const JoinedPoses join = joined(rig, limbs, first, second, kRate, {.fade = 20, .keeps_feet = keeps_feet});
    CHECK(join.fade_first == 100);
    REQUIRE(join.poses.size() == 200);
    CHECK(join.plants.empty() != keeps_feet);
    for (int f = 0; f < 200; ++f) {
      CHECK(glm::distance(join.poses[f].root_translation, whole[f].root_translation) < (keeps_feet ? 6 : 1e-6));
      for (std::size_t b = 0; b < rig.bones.size(); ++b)
        CHECK(glm::length(turn_between(join.poses[f].rotation[b], whole[f].rotation[b])) < (keeps_feet ? 0.02 : 1e-6));
    }
  }
}

TEST_CASE("joined poses: feet that stand stay in place while the takes fade") {
  const Armature rig = walker();
  const std::vector<PlantedLimb> limbs = planted_limbs(rig);
  // The second take is a few frames out of phase and turned a little further, so a foot slides during the fade.
  const std::vector<Pose> first = steps(rig, {}, 0, 120),
                          second = steps(rig, {0.12, {0, 0, 0}, {3000, 500, 0}}, 88, 140);
  const JoinedPoses free = joined(rig, limbs, first, second, kRate, {.fade = 24}),
                    kept = joined(rig, limbs, first, second, kRate, {.fade = 24, .keeps_feet = true});
  REQUIRE_FALSE(kept.plants.empty());
  double slid = 0;
  for (const Plant& plant : kept.plants) {
    slid = std::max(slid, error_of(plant, rig, limbs, free.poses).slide);
    CHECK(plant.first <= 119);
    CHECK(plant.last >= kept.fade_first);
    // Measures the foot by forward kinematics, independently of the code that plants it.
    const Bone& foot = rig.bones[limbs[plant.limb].end];
    const auto at = [&](int f) {
      return posed_from_rest(rig, kept.poses[f])[limbs[plant.limb].end] *
             (plant.point == PlantPoint::Tip ? foot.tail : foot.head);
    };
    for (int f = std::max(plant.first, kept.fade_first); f <= std::min(plant.last, 119); ++f) {
      const glm::dvec3 way = at(f) - at(std::max(plant.first, kept.fade_first));
      CHECK(std::hypot(way.x, way.y) < 10);
    }
  }
  CHECK(slid > 10);
  // Long before the cross-fade, the first take is unchanged.
  for (int f = 0; f < 40; ++f) CHECK(kept.poses[f] == first[f]);
}

TEST_CASE("joined poses: whatever the phases are, planted feet stay and the body does not jump") {
  const Armature rig = walker();
  const std::vector<PlantedLimb> limbs = planted_limbs(rig);
  const std::vector<Pose> whole = steps(rig, {}, 0, 240);
  const auto fastest = [&](const std::vector<Pose>& poses) {
    double most = 0;
    for (std::size_t f = 0; f + 1 < poses.size(); ++f)
      most = std::max(most, glm::distance(poses[f].root_translation, poses[f + 1].root_translation));
    return most;
  };
  const double usual = fastest(whole);
  int stood = 0;
  for (const int end : {90, 101, 112, 123})
    for (const int begin : {40, 53, 66, 79, 92})
      for (const int fade : {1, 9, 30, 60}) {
        CAPTURE(end);
        CAPTURE(begin);
        CAPTURE(fade);
        const std::vector<Pose> first(whole.begin(), whole.begin() + end), second(whole.begin() + begin, whole.end());
        const JoinedPoses join = joined(rig, limbs, first, second, kRate, {.fade = fade, .keeps_feet = true});
        for (const Plant& plant : join.plants) {
          CHECK(error_of(plant, rig, limbs, join.poses).slide < 10);
          stood += plant.first < end && plant.last >= join.fade_first;
        }
        // A foot may be held up to a seventh of a leg away from where a take has it. The body follows, spread over the
        // frames of the fade, so it becomes faster by less than 20 mm per frame.
        if (fade >= 30) CHECK(fastest(join.poses) < usual + 20);
      }
  CHECK(stood > 80);
}

TEST_CASE("joined poses: a foot that would have to go far without a step is told of") {
  const Armature rig = walker();
  const std::vector<PlantedLimb> limbs = planted_limbs(rig);
  // The body stands with both feet in front of it, then with both behind it.
  const auto standing = [&](double angle) {
    Pose pose = rest_pose(rig);
    for (const int thigh : {1, 4}) pose.rotation[thigh] = glm::angleAxis(angle, glm::dvec3(1, 0, 0));
    return std::vector<Pose>(60, pose);
  };
  const auto joined_at = [&](double before, double after) {
    return joined(rig, limbs, standing(before), standing(after), kRate, {.fade = 20, .keeps_feet = true});
  };
  const double far = joined_at(-0.3, 0.3).foot_gap;
  const PlantedLimb& left = limbs[0];
  const double joint = glm::distance(place_of(left, PlantPoint::Joint, rig, standing(-0.3)[0]),
                                     place_of(left, PlantPoint::Joint, rig, standing(0.3)[0]));
  CHECK(far >= joint - 1);
  CHECK(far < joint + 100);
  // If the two foot positions are close, they become one position, at which the foot stays.
  const JoinedPoses near = joined_at(-0.03, 0.03);
  CHECK(near.foot_gap == 0);
  REQUIRE(near.plants.size() >= 2);
  for (const Plant& plant : near.plants) {
    CHECK(plant.first == 0);
    CHECK(plant.last == 99);
    CHECK(error_of(plant, rig, limbs, near.poses).slide < 1);
  }
}

TEST_CASE("joined poses: a fade that is too long is refused") {
  const Armature rig = walker();
  const std::vector<Pose> take = sliding_steps(rig, 20), shorter = sliding_steps(rig, 5);
  for (const int fade : {0, -3, 6}) CHECK_THROWS_AS(joined(rig, {}, take, shorter, kRate, {.fade = fade}), Error);
  CHECK(joined(rig, {}, take, shorter, kRate, {.fade = 5}).poses.size() == 20);
}

}  // namespace limber::test
