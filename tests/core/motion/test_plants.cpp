// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/plants.h"

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/motion/pose_filter.h"
#include "tests/support/sliding_walker.h"

using namespace limber;
using test::sliding_steps;
using test::walker;

namespace {

double largest_step(const Armature& rig, const std::vector<Pose>& poses, const PlantedLimb& limb, PlantPoint point) {
  double most = 0;
  for (std::size_t f = 1; f < poses.size(); ++f)
    most =
        std::max(most, glm::distance(place_of(limb, point, rig, poses[f]), place_of(limb, point, rig, poses[f - 1])));
  return most;
}

}  // namespace

TEST_CASE("plants: limbs are found by name, and feet stand where they are low and slow") {
  const Armature rig = walker();
  const auto limbs = planted_limbs(rig);
  REQUIRE(limbs.size() == 4);
  CHECK(limbs[0].name == "left foot");
  CHECK(limbs[3].name == "right hand");
  const auto poses = sliding_steps(rig, 200);
  const auto plants = plants_of_feet(rig, limbs, poses, 60);
  CHECK(plants.size() >= 8);
  for (const Plant& plant : plants) {
    CHECK(limbs[plant.limb].is_leg);
    CHECK(error_of(plant, rig, limbs, poses).slide > 10);  // mm: the feet do slide before planting
    // In the middle of each stance that was found, the walker has the foot down.
    const double lift = std::sin((plant.first + plant.last) / 2.0 * 0.15 + plant.limb * std::numbers::pi);
    CHECK(lift < 0.5);
  }
}

TEST_CASE("plants: planted feet stay, lengths of bones stay, and nothing jumps") {
  const Armature rig = walker();
  const auto limbs = planted_limbs(rig);
  const auto poses = sliding_steps(rig, 200);
  const auto plants = plants_of_feet(rig, limbs, poses, 60);
  const auto cleaned = planted(rig, limbs, poses, plants, 9);
  REQUIRE(cleaned.size() == poses.size());
  for (const Plant& plant : plants) {
    CAPTURE(limbs[plant.limb].name);
    CAPTURE(plant.first);
    const PlantError error = error_of(plant, rig, limbs, cleaned);
    CHECK(error.slide < 1);
    CHECK(error.from_place < 1);
  }
  for (const PlantedLimb& limb : limbs)
    for (const PlantPoint point : {PlantPoint::Joint, PlantPoint::Tip})
      CHECK(largest_step(rig, cleaned, limb, point) < 2.5 * largest_step(rig, poses, limb, point) + 2);
  for (const Pose& pose : cleaned)
    for (const glm::dquat& turn : pose.rotation) CHECK(glm::length(turn) == doctest::Approx(1));
}

TEST_CASE("plants: a hand reaches a target exactly, keeps its direction, and a far target is missed by the rest") {
  const Armature rig = walker();
  const auto limbs = planted_limbs(rig);
  const auto poses = sliding_steps(rig, 100);
  test::RandomNumbers random(3);
  for (int trial = 0; trial < 40; ++trial) {
    Plant hold{2, PlantPoint::Tip, 40, 60, {}};
    // The target lies within the arm's reach in these frames.
    const glm::dvec3 direction =
        glm::normalize(glm::dvec3(random.any(-1, 1), random.any(-1, 0.2), random.any(-1, 1)) + glm::dvec3(1e-3));
    hold.place = glm::dvec3(200, -100, 1400) + direction * random.any(250, 420) - glm::dvec3(0, 0, 90);
    const auto held = planted(rig, limbs, poses, {hold}, 10);
    CHECK(error_of(hold, rig, limbs, held).from_place < 0.01);
    const auto direction_of_hand = [&](const Pose& pose) { return posed_from_rest(rig, pose)[limbs[2].end].rotation; };
    CHECK(std::abs(glm::dot(direction_of_hand(held[50]), direction_of_hand(poses[50]))) == doctest::Approx(1));
    CHECK(held[20].rotation == poses[20].rotation);  // unchanged far from the hold
    CHECK(held[80].rotation == poses[80].rotation);
  }
  Plant far{2, PlantPoint::Tip, 40, 60, {2000, 0, 1400}};
  const auto held = planted(rig, limbs, poses, {far}, 10);
  const double arm = 2000 - 200 - 300.17 - 250.2 - 90;
  CHECK(error_of(far, rig, limbs, held).from_place == doctest::Approx(arm).epsilon(0.15));
}

TEST_CASE("plants: a body sinks where a straight leg would not reach") {
  const Armature rig = walker();
  const auto limbs = planted_limbs(rig);
  std::vector<Pose> poses(60, rest_pose(rig));
  for (Pose& pose : poses) pose.root_translation.z = 30;  // mm above the ground: the feet hover
  Plant stand{0, PlantPoint::Joint, 20, 40, {100, -200, 80}};
  const auto cleaned = planted(rig, limbs, poses, {stand}, 6);
  CHECK(error_of(stand, rig, limbs, cleaned).from_place < 0.5);
  CHECK(cleaned[30].root_translation.z < 20);
  CHECK(cleaned[0].root_translation.z == doctest::Approx(30));
  for (std::size_t f = 1; f < cleaned.size(); ++f)
    CHECK(std::abs(cleaned[f].root_translation.z - cleaned[f - 1].root_translation.z) < 12);
}

TEST_CASE("plants: knees that the take bends the wrong way bend the right way where the foot stands, and never jump") {
  const Armature rig = walker();
  const auto limbs = planted_limbs(rig);
  // The knees are bent backwards, near the angle at which the bending plane is ill-defined.
  for (const double degrees : {2.0, 6.0, 12.0}) {
    CAPTURE(degrees);
    std::vector<Pose> poses;
    for (int f = 0; f < 120; ++f) {
      Pose pose = rest_pose(rig);
      const double wave = std::sin(f * 0.1);
      pose.rotation[2] = glm::angleAxis(glm::radians(-degrees * (0.5 + 0.5 * wave) + 1), glm::dvec3(1, 0, 0));
      pose.root_translation = {0, 3 * wave, -4};
      poses.push_back(pose);
    }
    Plant stand{0, PlantPoint::Joint, 30, 80, place_of(limbs[0], PlantPoint::Joint, rig, poses[50])};
    stand.place += glm::dvec3(0, 5, 12);
    const auto cleaned = planted(rig, limbs, poses, {stand}, 10);
    CHECK(error_of(stand, rig, limbs, cleaned).from_place < 1);
    double largest = 0;
    for (std::size_t f = 1; f < cleaned.size(); ++f)
      for (const int bone : {limbs[0].upper, limbs[0].lower}) {
        const double cosine = std::abs(glm::dot(cleaned[f].rotation[bone], cleaned[f - 1].rotation[bone]));
        largest = std::max(largest, glm::degrees(2 * std::acos(std::min(1.0, cosine))));
      }
    CHECK(largest < 8);
  }
}

TEST_CASE("plants: feet without length or on another bone are none, and far places neither break nor sink a body") {
  Armature rig = walker();
  const int foot = require_bone(rig, "LeftFoot");
  rig.bones[foot].tail = rig.bones[foot].head;
  rig.bones[require_bone(rig, "RightFoot")].parent = 0;
  const auto limbs = planted_limbs(rig);
  CHECK(limbs[0].end == -1);
  CHECK(limbs[1].end == -1);
  const auto poses = sliding_steps(rig, 60);
  for (const double far : {500.0, 900.0, 1e6}) {
    const auto cleaned = planted(rig, limbs, poses, {{0, PlantPoint::Tip, 20, 40, {100, -far, 60}}}, 8);
    for (std::size_t f = 0; f < cleaned.size(); ++f) {
      CHECK(std::abs(cleaned[f].root_translation.z - poses[f].root_translation.z) < 400);
      for (const glm::dquat& turn : cleaned[f].rotation) CHECK(glm::length(turn) == doctest::Approx(1));
    }
  }
}

TEST_CASE("plants: what is held is not planted as well, and two holds of one limb may not overlap") {
  const std::vector<Plant> plants{{0, PlantPoint::Tip, 10, 50, {}}, {1, PlantPoint::Tip, 10, 50, {}}};
  const auto left = without_held(plants, {0, PlantPoint::Tip, 25, 30, {}}, 3);
  REQUIRE(left.size() == 3);
  CHECK(left[0].last == 21);
  CHECK(left[1].first == 34);
  CHECK(left[2].limb == 1);
  const Armature rig = walker();
  CHECK_THROWS_WITH_AS(planted(rig, planted_limbs(rig), sliding_steps(rig, 60),
                               {{2, PlantPoint::Tip, 10, 20, {}}, {2, PlantPoint::Tip, 20, 30, {}}}, 3),
                       doctest::Contains("two places at once"), Error);
}

TEST_CASE("plants: hands that hang idle go with the body, and those that stay while the body moves or comes stay") {
  const Armature rig = walker();
  const auto limbs = planted_limbs(rig);
  const auto hands_of = [&](const std::vector<Pose>& poses) {
    std::vector<Plant> hands = held_by_world(plants_at_rest(rig, limbs, poses, 60), rig, limbs, poses, 60);
    std::erase_if(hands, [&](const Plant& plant) { return limbs[plant.limb].is_leg; });
    return hands;
  };
  std::vector<Pose> idle(120, rest_pose(rig));
  for (int f = 0; f < 120; ++f) idle[f].root_translation = {0.6 * std::sin(f * 0.1), 0, 0};
  CHECK(plants_at_rest(rig, limbs, idle, 60).size() == 6);
  CHECK(hands_of(idle).empty());
  // Holding a foot far aside moves the body and the hands with it. Relative to the body, the hands do not change.
  std::vector<Plant> plants = held_by_world(plants_at_rest(rig, limbs, idle, 60), rig, limbs, idle, 60);
  const Plant hold{0, PlantPoint::Tip, 40, 80,
                   place_of(limbs[0], PlantPoint::Tip, rig, idle[60]) + glm::dvec3(300, 0, 0)};
  plants = without_held(plants, hold, 9);
  plants.push_back(hold);
  const auto aside = planted(rig, limbs, idle, plants, 9);
  REQUIRE(glm::distance(aside[60].root_translation, idle[60].root_translation) > 100);
  for (const int bone : {limbs[2].upper, limbs[2].lower, limbs[3].upper, limbs[3].lower})
    CHECK(std::abs(glm::dot(aside[60].rotation[bone], idle[60].rotation[bone])) == doctest::Approx(1));

  // One hand rests on a rail while the body sways. Another is moved to a position while the body stands.
  std::vector<Pose> sways = idle;
  for (int f = 0; f < 120; ++f) sways[f].root_translation = {15 * std::sin(f * 0.1), 0, 0};
  const glm::dvec3 hip = place_of(limbs[2], PlantPoint::Tip, rig, idle[60]) + glm::dvec3(0, -80, 200);
  const auto on_rail = hands_of(planted(rig, limbs, sways, {{2, PlantPoint::Tip, 0, 119, hip}}, 9));
  REQUIRE(on_rail.size() == 1);
  CHECK(on_rail[0].limb == 2);
  const auto put = hands_of(planted(rig, limbs, idle, {{2, PlantPoint::Tip, 40, 80, hip}}, 9));
  CHECK(std::any_of(put.begin(), put.end(), [](const Plant& p) { return p.limb == 2 && p.first < 45 && p.last > 75; }));
}

TEST_CASE("plants: wrong frames and limbs are refused, and no frames have no plants") {
  const Armature rig = walker();
  const auto limbs = planted_limbs(rig);
  const auto poses = sliding_steps(rig, 10);
  CHECK_THROWS_AS(planted(rig, limbs, poses, {{0, PlantPoint::Tip, 5, 10, {}}}, 3), Error);
  CHECK_THROWS_AS(planted(rig, limbs, poses, {{0, PlantPoint::Tip, 6, 5, {}}}, 3), Error);
  CHECK_THROWS_AS(planted(rig, limbs, poses, {{4, PlantPoint::Tip, 0, 5, {}}}, 3), Error);
  CHECK(planted(rig, limbs, {}, {}, 3).empty());
  CHECK(plants_of_feet(rig, limbs, {}, 30).empty());
  Armature stick;
  stick.bones.push_back({"thing", -1, {0, 0, 0}, {0, 0, 100}, 0, {}});
  CHECK(planted_limbs(stick).empty());
}

TEST_CASE("pose filter: slow movement stays, fast movement goes, nothing lags") {
  const Armature rig = walker();
  constexpr double kRate = 120;
  // Returns the gain at a frequency of two passes of a second-order Butterworth filter: 1 / (1 + (tan ratio)^4). The
  // cutoff of one pass is raised so that both passes together halve the power at the given cutoff.
  const auto gain_of = [&](double frequency, double cutoff) {
    const double raised = cutoff / std::pow(std::numbers::sqrt2 - 1, 0.25);
    const double ratio = std::tan(std::numbers::pi * frequency / kRate) / std::tan(std::numbers::pi * raised / kRate);
    return 1 / (1 + std::pow(ratio, 4));
  };
  for (const double frequency : {1.0, 4.0, 6.0, 12.0, 30.0}) {
    CAPTURE(frequency);
    std::vector<Pose> poses;
    for (int f = 0; f < 720; ++f) {
      Pose pose = rest_pose(rig);
      const double wave = std::sin(2 * std::numbers::pi * frequency * f / kRate);
      pose.root_translation.x = 10 * wave;
      pose.rotation[2] = glm::angleAxis(0.02 * wave, glm::dvec3(1, 0, 0));
      if (f % 3 == 0) pose.rotation[2] = -pose.rotation[2];  // the opposite quaternion is the same rotation
      poses.push_back(pose);
    }
    const auto result = smoothed(poses, kRate, 6);
    for (int f = 240; f < 480; ++f) {
      const double wave = std::sin(2 * std::numbers::pi * frequency * f / kRate) * gain_of(frequency, 6);
      CHECK(result[f].root_translation.x == doctest::Approx(10 * wave).epsilon(0.01).scale(1));
      const glm::dquat turn = result[f].rotation[2].w < 0 ? -result[f].rotation[2] : result[f].rotation[2];
      CHECK(turn.x == doctest::Approx(0.01 * wave).epsilon(0.01).scale(0.001));
    }
  }
  CHECK(smoothed(std::vector<Pose>(2, rest_pose(rig)), 30, 6).size() == 2);
  CHECK_THROWS_AS(smoothed({}, 30, 13), Error);
  CHECK_THROWS_AS(smoothed({}, 30, 0), Error);
  CHECK_THROWS_AS(smoothed({}, 30, std::nan("")), Error);
}

TEST_CASE("pose filter: a straight line stays one up to its ends, and turning the body turns the result") {
  const Armature rig = walker();
  std::vector<Pose> poses = sliding_steps(rig, 120, 0.05);
  for (int f = 0; f < 120; ++f) poses[f].root_translation = {5.0 * f, 0, 0};
  const auto result = smoothed(poses, 60, 6);
  for (int f = 0; f < 120; ++f) CHECK(result[f].root_translation.x == doctest::Approx(5.0 * f).epsilon(1e-6).scale(1));
  const glm::dquat turn = glm::normalize(glm::dquat(0.3, 0.5, -0.2, 0.7));
  std::vector<Pose> turned = poses;
  for (Pose& pose : turned) pose.rotation[0] = turn * pose.rotation[0];
  const auto of_turned = smoothed(turned, 60, 6);
  for (int f = 0; f < 120; ++f)
    CHECK(std::abs(glm::dot(of_turned[f].rotation[0], turn * result[f].rotation[0])) == doctest::Approx(1));
}

TEST_CASE("pose filter: a few frames keep their ends") {
  const Armature rig = walker();
  for (const int frames : {3, 5, 12}) {
    std::vector<Pose> poses(frames, rest_pose(rig));
    for (int f = 0; f < frames; ++f) poses[f].root_translation.z = 90 + 10 * f;
    const auto result = smoothed(poses, 120, 6);
    for (int f = 0; f < frames; ++f) CHECK(result[f].root_translation.z == doctest::Approx(90 + 10 * f));
  }
}
