// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/foot_sliding.h"

#include <cmath>
#include <functional>

#include <doctest/doctest.h>
#include <glm/gtc/quaternion.hpp>

using namespace limber;

namespace {
constexpr double kFrameTime = 0.02;

glm::dvec3 turned(const glm::dvec3& rotation, const glm::dvec3& way) {
  const double angle = glm::length(rotation);
  return angle > 0 ? glm::angleAxis(angle, rotation / angle) * way : way;
}

// Makes an upright leg 800 mm long from the paths of the source's ankle and of the body's ankle.
FootTrack leg_of(int frames, const std::function<glm::dvec3(int)>& source, const std::function<glm::dvec3(int)>& body) {
  FootTrack leg{.rest_height = 60, .most_turn = 0.034};
  for (int f = 0; f < frames; ++f) {
    leg.source[FootTrack::Ankle].push_back(source(f));
    leg.body[FootTrack::Ankle].push_back(body(f));
    leg.knee.push_back(body(f) + glm::dvec3(0, 0, 400));
    leg.hip.push_back(body(f) + glm::dvec3(0, 0, 800));
  }
  return leg;
}

double farthest_slide(const FootTrack& leg, const FootMending& mending, std::size_t i, int begin, int end) {
  double farthest = 0;
  const auto place = [&](int f) {
    return leg.body[FootTrack::Ankle][f] + mending.travel[f] + glm::dvec3(mending.ankle_aside[i][f], 0);
  };
  for (int f = begin; f < end; ++f) farthest = std::max(farthest, glm::length(glm::dvec2(place(f) - place(begin))));
  return farthest;
}
}  // namespace

TEST_CASE(
    "foot sliding: turns of a leg move its ankle as asked, evenly where it is straight, and keep its height where it "
    "is bent") {
  const glm::dvec3 straight(0, 0, -400);
  const TurnsOfLeg even = turns_of_leg(straight, straight, {8, 6});
  CHECK(glm::length(even.thigh - even.shank) < 1e-12);
  CHECK(even.most() == doctest::Approx(10.0 / 800).epsilon(0.01));

  // The body sits: the thigh is level, the shank upright, so mainly the shank can move the foot.
  const glm::dvec3 lying(0, -400, 0), standing(0, 0, -350);
  for (const glm::dvec2 aside : {glm::dvec2(0, 9), glm::dvec2(7, 0), glm::dvec2(-4, 5)}) {
    const TurnsOfLeg turns = turns_of_leg(lying, standing, aside);
    const glm::dvec3 moved = turned(turns.thigh, lying) + turned(turns.shank, standing) - lying - standing;
    CHECK(glm::length(glm::dvec2(moved) - aside) < 0.02 * glm::length(aside));
    CHECK(std::abs(moved.z) < 1);
  }

  // With a straight, leaning leg the foot reaches the horizontal position, but cannot keep its height.
  const glm::dvec3 leaning(200, 0, -350);
  const TurnsOfLeg turns = turns_of_leg(leaning, leaning, {10, 0});
  const glm::dvec3 moved = turned(turns.thigh, leaning) + turned(turns.shank, leaning) - 2.0 * leaning;
  CHECK(moved.x == doctest::Approx(10).epsilon(0.03));
}

TEST_CASE("foot sliding: of one foot that stands the travel takes nearly all, and nothing gives at frame 0") {
  // The source's foot stands, and the body's foot is carried along. The other leg is in the air.
  const FootTrack stands = leg_of(
      100, [](int) { return glm::dvec3(0); }, [](int f) { return glm::dvec3(3.0 * f, -f, 60); });
  const FootTrack flies = leg_of(
      100, [](int f) { return glm::dvec3(20.0 * f, 0, f == 0 ? 0 : 300); },
      [](int f) { return glm::dvec3(20.0 * f, 0, f == 0 ? 60 : 360); });
  const FootMending mending = mend_sliding({stands, flies}, kFrameTime, true);
  CHECK(farthest_slide(stands, mending, 0, 0, 100) < 0.3);
  CHECK(glm::length(glm::dvec2(mending.travel[99]) - glm::dvec2(-297, 99)) < 0.1 * 313);
  CHECK(glm::length(mending.travel[0]) < 1e-3);
  CHECK(glm::length(mending.ankle_aside[0][0]) < 1e-3);
}

TEST_CASE("foot sliding: two feet that want different things stand by their legs, as far as these may turn") {
  const auto still = [](int) { return glm::dvec3(0); };
  for (const double apart : {15.0, 90.0}) {
    // The body's feet drift apart while both feet of the source stand.
    const FootTrack left = leg_of(200, still, [&](int f) { return glm::dvec3(0, apart * f / 400, 60); });
    const FootTrack right = leg_of(200, still, [&](int f) { return glm::dvec3(0, -apart * f / 400, 60); });
    const FootMending mending = mend_sliding({left, right}, kFrameTime, true);
    CAPTURE(apart);
    const double slid = farthest_slide(left, mending, 0, 0, 200) + farthest_slide(right, mending, 1, 0, 200);
    const double reach = 2 * 0.034 * 800;
    if (apart < reach) CHECK(slid < 0.5);
    else CHECK(slid == doctest::Approx(apart - reach).epsilon(0.1));
    for (int f = 0; f < 200; ++f) REQUIRE(glm::length(mending.ankle_aside[0][f]) < 0.034 * 800 * 1.001);
  }
}

TEST_CASE("foot sliding: a foot that rolls holds by its toes once its ankle moves") {
  // Both feet have the same length and turn about their toes, but the body's ankle is half as high.
  const int frames = 30;
  const auto ankle = [](double high, int f) {
    return glm::dvec3(0, 100, 0) + glm::dvec3(0, -std::cos(f * 0.02) * 100 + std::sin(f * 0.02) * high,
                                              std::sin(f * 0.02) * 100 + std::cos(f * 0.02) * high);
  };
  FootTrack leg = leg_of(
      frames, [&](int f) { return ankle(100, f); }, [&](int f) { return ankle(50, f); });
  for (int f = 0; f < frames; ++f) {
    leg.source[FootTrack::Toes].push_back({0, 100, 0});
    leg.body[FootTrack::Toes].push_back({0, 100, 0});
  }
  const FootMending mending = mend_sliding({leg}, kFrameTime, true);
  double slid = 0;
  for (int f = 0; f < frames; ++f)
    slid = std::max(slid,
                    glm::length(glm::dvec2(mending.travel[f]) + mending.ankle_aside[0][f] + mending.toes_aside[0][f]));
  CHECK(slid < 1);
}

TEST_CASE("foot sliding: without a way along the ground only heights are mended") {
  const FootTrack leg = leg_of(
      3, [](int) { return glm::dvec3(0); }, [](int f) { return glm::dvec3(9.0 * f, 0, 75); });
  const FootMending mending = mend_sliding({leg}, kFrameTime, false);
  CHECK(mending.ankle_aside.empty());
  for (const glm::dvec3& travel : mending.travel) CHECK(glm::length(travel - glm::dvec3(0, 0, -15)) < 1e-9);
}
