// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/joint_landmarks.h"

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>
#include <glm/gtc/quaternion.hpp>

namespace limber {

namespace {

constexpr double kPi = std::numbers::pi;

const BodyAtlas& leg() {
  static const BodyAtlas atlas = make_atlas(AtlasKind::Leg);
  return atlas;
}

// Makes tissue in round cross-sections along a leg. `radius` gives their radius by the distance below the hip, both in
// mm.
template <class Radius>
Occupancy round_leg(const Mannequin& m, const Radius& radius) {
  const glm::dvec3 hip = m.joint(require_bone(m.atlas().rig, "Thigh")),
                   knee = m.joint(require_bone(m.atlas().rig, "Shank")),
                   ankle = m.joint(require_bone(m.atlas().rig, "Foot"));
  const glm::dvec3 low = glm::min(hip, ankle) - 150.0, high = glm::max(hip, ankle) + 150.0;
  Occupancy cells{{glm::ivec3((high - low) / 4.0), {4, 4, 4}, low, glm::dmat3(1)}, {}};
  for (int z = 0; z < cells.grid.size.z; ++z)
    for (int y = 0; y < cells.grid.size.y; ++y)
      for (int x = 0; x < cells.grid.size.x; ++x) {
        const glm::dvec3 p = low + 4.0 * glm::dvec3(x, y, z);
        const glm::dvec3 a = p.z > knee.z ? hip : knee, b = p.z > knee.z ? knee : ankle, axis = glm::normalize(b - a);
        const double along = glm::dot(p - a, axis);
        cells.share.push_back(
            glm::distance(p, a + along * axis) < radius(along + (p.z > knee.z ? 0 : glm::distance(hip, knee))) ? 1 : 0);
      }
  return cells;
}

}  // namespace

TEST_CASE(
    "joint landmarks: the knee is found where the girth is least, wherever the body that was laid over it has its "
    "own") {
  const Mannequin m(leg());
  const int shank = require_bone(leg().rig, "Shank");
  const double thigh = glm::distance(m.joint(require_bone(leg().rig, "Thigh")), m.joint(shank));
  for (double off : {-60.0, 0.0, 60.0}) {
    const Occupancy body =
        round_leg(m, [&](double along) { return 50 + 20 * std::min(1.0, std::abs(along - thigh - off) / 150); });
    const auto found = girth_landmarks(m, body);
    REQUIRE(found.size() == 1);
    CHECK(found[0].bone == shank);
    const glm::dvec3 way = found[0].place - m.joint(shank);
    // The error may be two distances between sections, plus the 1 % of the thigh's length by which the knee lies below
    // the narrowest section, mm.
    CHECK(std::abs(-way.z - off) < 12);
  }
}

TEST_CASE("joint landmarks: a waist says how far the limb is bent there") {
  Mannequin m(leg());
  const int shank = require_bone(leg().rig, "Shank"), hip = require_bone(leg().rig, "Thigh"),
            foot = require_bone(leg().rig, "Foot");
  for (double more : {0.0, 0.3}) {
    m.turn_branch(shank, glm::mat3_cast(glm::angleAxis(more, glm::dvec3(1, 0, 0))));
    const double thigh = glm::distance(m.joint(hip), m.joint(shank));
    const auto found = girth_landmarks(
        m, round_leg(m, [&](double along) { return 50 + 20 * std::min(1.0, std::abs(along - thigh) / 150); }));
    REQUIRE(found.size() == 1);
    const double straight =
        glm::dot(glm::normalize(m.joint(shank) - m.joint(hip)), glm::normalize(m.joint(foot) - m.joint(shank)));
    CHECK(found[0].bend == doctest::Approx(std::acos(straight)));
    CHECK(found[0].bend > more - 0.2);
  }
}

TEST_CASE("joint landmarks: a limb without a waist tells nothing") {
  const Mannequin m(leg());
  CHECK(girth_landmarks(m, round_leg(m, [](double along) { return 90 - 0.08 * along; })).empty());
}

TEST_CASE("joint landmarks: a limb that lies against something tells nothing there") {
  const Mannequin m(leg());
  const int shank = require_bone(leg().rig, "Shank");
  const double thigh = glm::distance(m.joint(require_bone(leg().rig, "Thigh")), m.joint(shank));
  const auto waisted = [&](double along) { return 50 + 20 * std::min(1.0, std::abs(along - thigh) / 150); };
  REQUIRE(girth_landmarks(m, round_leg(m, waisted)).size() == 1);
  Occupancy beside = round_leg(m, waisted);
  const glm::ivec3 size = beside.grid.size, knee(glm::round(voxel_from_world(beside.grid) * m.joint(shank)));
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = knee.x; x < size.x; ++x) beside.share[beside.grid.index({x, y, z})] = 1;
  CHECK(girth_landmarks(m, beside).empty());
}

TEST_CASE("joint landmarks: the hip is the middle of its ball, from half of the ball and beside other bone") {
  const Mannequin m(leg());
  const int thigh = require_bone(leg().rig, "Thigh");
  for (const glm::dvec3& off : {glm::dvec3(14, -9, 6), glm::dvec3(-18, 0, -8)})
    for (double radius : {20.0, 25.0}) {
      const glm::dvec3 centre = m.joint(thigh) + off;
      std::vector<SurfacePoint> points;
      for (double polar = 0; polar < kPi / 2; polar += 0.08)
        for (double turn = 0; turn < 2 * kPi; turn += 0.08 / std::max(0.05, std::sin(polar))) {
          const glm::dvec3 out(std::cos(turn) * std::sin(polar), std::sin(turn) * std::sin(polar), std::cos(polar));
          points.push_back({centre + radius * out, out});
          points.push_back({centre + (radius + 4) * out, -out});  // points of the socket around the head
        }
      for (double along = 20; along < 60; along += 2)  // points of a shaft
        for (double turn = 0; turn < 2 * kPi; turn += 0.2) {
          const glm::dvec3 out(std::cos(turn), std::sin(turn), 0);
          points.push_back({centre + glm::dvec3(25, 0, -along) + 14.0 * out, out});
        }
      const auto found = ball_landmarks(m, FitSurface(points, 5));
      REQUIRE(found.size() == 1);
      CHECK(found[0].bone == thigh);
      CHECK(glm::distance(found[0].place, centre) < 1);
    }
  CHECK(ball_landmarks(m, FitSurface({{m.joint(thigh), {0, 0, 1}}}, 5)).empty());
}

}  // namespace limber
