// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/reduce_planted.h"

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/motion/clean_motion.h"
#include "core/motion/clip.h"
#include "core/motion/pose_filter.h"
#include "tests/support/sliding_walker.h"
#include "tests/support/walker.h"

namespace limber::test {

namespace {

constexpr int kFrames = 120, kStart = 40;
constexpr double kRate = 60;

// A walker's steps, cleaned, with one hand held in place.
struct CleanWalk {
  const Armature rig = walker();
  const std::vector<PlantedLimb> limbs = planted_limbs(rig);
  CleanedMotion cleaned =
      clean_motion(rig, limbs, smoothed(sliding_steps(rig, kFrames, 0.02), kRate, 6), kRate, true, {held_hand()}, 0.15);

  Plant held_hand() const {
    const std::vector<Pose> steps = smoothed(sliding_steps(rig, kFrames, 0.02), kRate, 6);
    const glm::dvec3 hand = place_of(limbs[2], PlantPoint::Tip, rig, steps[60]),
                     shoulder = rig.bones[limbs[2].upper].head;
    return {2, PlantPoint::Tip, 55, 70, hand + 0.2 * (shoulder + steps[60].root_translation - hand)};
  }

  // Plays the keys the same way as the program plays clips.
  std::vector<Pose> played(const Keys& keys) const {
    Clip clip{.name = "keys", .rate = kRate, .start = kStart, .range_start = kStart, .range_end = kStart + kFrames - 1};
    clip.keys = keys;
    const ClipOnRig on_rig(std::make_shared<const Clip>(clip), std::make_shared<const Armature>(rig));
    std::vector<Pose> poses;
    for (int f = 0; f < kFrames; ++f) poses.push_back(on_rig.at(kStart + f));
    return poses;
  }
  double farthest(const std::vector<Plant>& plants, const std::vector<Pose>& poses) const {
    double most = 0;
    for (const Plant& plant : plants)
      for (int f = plant.first; f <= plant.last; ++f)
        most = std::max(most, glm::distance(place_of(limbs[plant.limb], plant.point, rig, poses[f]),
                                            place_of(limbs[plant.limb], plant.point, rig, cleaned.poses[f])));
    return most;
  }
};

}  // namespace

TEST_CASE("reduced keys: feet that stand and a hand that is held stay in place, elsewhere the bones' error holds") {
  const CleanWalk walk;
  const std::vector<Plant> resting = resting_limbs(walk.rig, walk.limbs, walk.cleaned.poses, kRate);
  const auto is_hand = [](const Plant& plant) { return plant.limb == 2; };
  REQUIRE(std::count_if(resting.begin(), resting.end(), is_hand) == 1);
  const Plant hand = *std::find_if(resting.begin(), resting.end(), is_hand);
  CHECK(hand.first <= 56);
  CHECK(hand.last >= 69);
  CHECK(resting.size() >= 5);

  const ReduceSettings settings{.degrees = 1, .mm = 2};
  const ReducedKeys plain = reduced_to_keys(walk.rig, walk.cleaned.poses, kStart, settings, no_progress());
  CHECK(walk.farthest(resting, walk.played(plain.keys)) > 3);
  for (const double mm : {1.0, 0.1}) {
    CAPTURE(mm);
    const PlantedKeys kept =
        reduced_with_plants(walk.rig, walk.limbs, walk.cleaned.poses, kStart, settings, resting, mm, no_progress());
    const double off = walk.farthest(resting, walk.played(kept.reduced.keys));
    CHECK(off <= mm);
    CHECK(off == doctest::Approx(kept.most_off).epsilon(1e-6));
    CHECK(kept.reduced.most_degrees <= settings.degrees);
    CHECK(kept.reduced.most_mm <= settings.mm);
    // The keys are still few: fewer than a third of one for each moving bone and frame.
    CHECK(kept.reduced.count >= plain.count);
    CHECK(kept.reduced.count < std::ssize(kept.reduced.keys.bones) * kFrames / 3);
  }
}

TEST_CASE("plants: a limb rests while it is held, and neither where a swing turns nor while it drifts slowly") {
  const CleanWalk walk;
  const auto hands_of = [&](const std::vector<Pose>& poses) {
    std::vector<Plant> hands;
    for (const Plant& plant : plants_at_rest(walk.rig, walk.limbs, poses, kRate))
      if (!walk.limbs[plant.limb].is_leg) hands.push_back(plant);
    return hands;
  };
  const Plant held = walk.held_hand();
  const std::vector<Plant> hands = hands_of(walk.cleaned.poses);
  REQUIRE(hands.size() == 1);
  CHECK(hands[0].limb == 2);
  CHECK(std::abs(hands[0].first - held.first) <= 1);
  CHECK(std::abs(hands[0].last - held.last) <= 1);
  CHECK(glm::distance(hands[0].place, held.place) < 0.5);

  std::vector<Pose> drifting(kFrames, rest_pose(walk.rig)), swinging = drifting, still = drifting;
  for (int f = 0; f < kFrames; ++f) {
    drifting[f].root_translation = {0.25 * f, 0, 0};  // the body drifts by 15 mm/s
    swinging[f].rotation[8] = glm::angleAxis(0.6 * std::sin(f * 0.1), glm::dvec3(1, 0, 0));
    still[f].root_translation = {0.4 * std::sin(f * 1.3), 0, 0};  // the body trembles, mm
  }
  CHECK(hands_of(drifting).empty());
  const std::vector<Plant> other_hand = hands_of(swinging);
  REQUIRE(other_hand.size() == 1);
  CHECK(other_hand[0].limb == 3);
  REQUIRE(hands_of(still).size() == 2);
  CHECK(hands_of(still)[0].first == 0);
  CHECK(hands_of(still)[0].last == kFrames - 1);
}

TEST_CASE("plants: a limb that was held rests there, however slowly it moves before and after") {
  const CleanWalk walk;
  for (const double speed : {4.0, 12.0}) {  // speed of the body, mm/s
    CAPTURE(speed);
    std::vector<Pose> poses(kFrames, rest_pose(walk.rig));
    for (int f = 0; f < kFrames; ++f)
      poses[f].root_translation = {speed / kRate * (std::min(f, 50) + std::max(0, f - 70)), 0, 0};
    std::vector<Plant> rests = plants_at_rest(walk.rig, walk.limbs, poses, kRate);
    std::erase_if(rests, [&](const Plant& plant) { return walk.limbs[plant.limb].is_leg; });
    REQUIRE(rests.size() == 2);
    for (const Plant& rest : rests) {
      CHECK(rest.first >= 45);
      CHECK(rest.first <= 50);
      CHECK(rest.last >= 70);
      CHECK(rest.last <= 75);
      CHECK(glm::distance(rest.place, place_of(walk.limbs[rest.limb], PlantPoint::Tip, walk.rig, poses[60])) < 0.1);
    }
  }
}

TEST_CASE("plants: a cancel takes effect while rests are sought, judged and planted") {
  const CleanWalk walk;
  const std::vector<Pose>& poses = walk.cleaned.poses;
  const std::vector<Plant> rests = plants_at_rest(walk.rig, walk.limbs, poses, kRate);
  Progress stopped;
  stopped.cancel();
  CHECK_THROWS_AS(plants_at_rest(walk.rig, walk.limbs, poses, kRate, stopped), Cancelled);
  CHECK_THROWS_AS(plants_of_feet(walk.rig, walk.limbs, poses, kRate, stopped), Cancelled);
  CHECK_THROWS_AS(held_by_world(rests, walk.rig, walk.limbs, poses, kRate, stopped), Cancelled);
  CHECK_THROWS_AS(planted(walk.rig, walk.limbs, poses, rests, 9, stopped), Cancelled);
}

TEST_CASE("reduced keys: without plants nothing changes, and an error of zero is refused") {
  const CleanWalk walk;
  const PlantedKeys kept = reduced_with_plants(walk.rig, walk.limbs, walk.cleaned.poses, 0, {}, {}, 1, no_progress());
  CHECK(kept.reduced.keys == reduced_to_keys(walk.rig, walk.cleaned.poses, 0, ReduceSettings{}, no_progress()).keys);
  CHECK(kept.most_off == 0);
  CHECK_THROWS_AS(reduced_with_plants(walk.rig, walk.limbs, walk.cleaned.poses, 0, {}, {}, 0, no_progress()), Error);
}

}  // namespace limber::test
