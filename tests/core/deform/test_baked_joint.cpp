// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/baked_joint.h"

#include <cmath>
#include <memory>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/deform/baked_flesh.h"

using namespace limber;

namespace {

const std::vector<double> kDegrees = {-20, 0, 10, 35, 80};

// A joint in a block of 24 voxels of 2 mm whose nodes shift by (1, 2, 3) mm times a function of the angle.
std::shared_ptr<const BakedJoint> even_joint(double (*function)(double), const std::vector<double>& degrees) {
  BakedJoint joint{.bone = "Lower", .axis = {1, 0, 0}, .degrees = degrees};
  joint.step = glm::ivec3(4);
  joint.first = glm::ivec3(1);
  joint.size = glm::ivec3(5);
  for (int place = 0; place < 125; ++place) joint.nodes.push_back(place);
  for (const double angle : degrees) {
    joint.shifts.emplace_back();
    if (angle != 0) joint.shifts.back().assign(125, glm::vec3(1, 2, 3) * float(function(angle)));
  }
  return std::make_shared<const BakedJoint>(std::move(joint));
}

LabelVolume block() {
  LabelVolume volume;
  volume.grid.size = glm::ivec3(24);
  volume.grid.spacing = glm::dvec3(2);
  volume.voxels.assign(volume.grid.voxel_count(), 1);
  return volume;
}

}  // namespace

TEST_CASE("baked joint: at a baked angle its shifts count alone, and at rest none") {
  for (std::size_t a = 0; a < kDegrees.size(); ++a) {
    const auto shares = shares_at(kDegrees, kDegrees[a]);
    if (kDegrees[a] == 0) CHECK(shares.empty());
    else {
      REQUIRE(shares.size() == 1);
      CHECK(shares[0] == std::pair<int, double>(int(a), 1.0));
    }
  }
}

TEST_CASE("baked joint: between baked angles the shifts follow a parabola exactly, and a sine closely") {
  const auto value = [&](double angle, auto function) {
    double sum = 0;
    for (const auto& [a, share] : shares_at(kDegrees, angle)) sum += share * function(kDegrees[a]);
    return sum;
  };
  for (double angle = -20; angle <= 80; angle += 1.7) {
    CAPTURE(angle);
    const auto parabola = [](double x) { return 0.3 * x + 0.02 * x * x; };
    CHECK(value(angle, parabola) == doctest::Approx(parabola(angle)).epsilon(1e-9));
    const auto sine = [](double x) { return std::sin(glm::radians(x)); };
    CHECK(std::abs(value(angle, sine) - sine(angle)) < (angle < 10 ? 0.002 : 0.02));
    CHECK(shares_at(kDegrees, angle).size() <= 4);
  }
}

TEST_CASE("baked joint: beyond the baked range the shifts are those of its end") {
  CHECK(shares_at(kDegrees, 100) == shares_at(kDegrees, 80));
  CHECK(shares_at(kDegrees, -179) == shares_at(kDegrees, -20));
}

TEST_CASE("baked joint: a turn splits into its angle about the axis and the rest") {
  const glm::dvec3 axis(0, 0, 1);
  for (const double degrees : {-170.0, -30.0, 0.0, 45.0, 179.0}) {
    const glm::dquat about = glm::angleAxis(glm::radians(degrees), axis);
    for (const glm::dquat& turn : {about, -about}) {
      CHECK(turn_about_axis(turn, axis).degrees == doctest::Approx(degrees));
      CHECK(turn_about_axis(turn, axis).other_degrees < 1e-5);
    }
    const glm::dquat swing = glm::angleAxis(glm::radians(25.0), glm::dvec3(0.6, 0.8, 0));
    CHECK(turn_about_axis(swing * about, axis).degrees == doctest::Approx(degrees));
    CHECK(turn_about_axis(swing * about, axis).other_degrees == doctest::Approx(25));
  }
}

TEST_CASE("baked flesh: shifts turn with the bone above the joint, and fade to nothing around the nodes") {
  const LabelVolume volume = block();
  const TissueVoxels tissue(volume);
  const auto joint = even_joint([](double x) { return x / 40; }, {0, 40, 80});
  const glm::dquat turn = glm::angleAxis(glm::radians(90.0), glm::dvec3(0, 0, 1));
  const BakedFlesh flesh(tissue, volume.grid, {{joint, 60, turn}});
  // At 60 degrees, halfway from 40 to 80, the shift is 1.5 times (1, 2, 3) mm. The bone's turn by 90 degrees about z
  // makes it (-3, 1.5, 4.5) mm; a voxel has 2 mm.
  CHECK(glm::distance(flesh.shift_at({12, 12, 12}), glm::vec3(-1.5f, 0.75f, 2.25f)) < 1e-5f);
  CHECK(glm::distance(flesh.shift_at({2, 12, 12}), 0.5f * glm::vec3(-1.5f, 0.75f, 2.25f)) < 1e-5f);
  CHECK(flesh.shift_at({0, 12, 12}) == glm::vec3(0));
  CHECK(flesh.shift_at({24, 12, 12}) == glm::vec3(0));
  CHECK(BakedFlesh(tissue, volume.grid, {{joint, 0, turn}}).empty());
}

TEST_CASE("baked flesh: bricks agree on the corners that they share, and two joints add up") {
  const LabelVolume volume = block();
  const TissueVoxels tissue(volume);
  const auto joint = even_joint([](double x) { return x / 40; }, {0, 40, 80});
  const auto other = even_joint([](double x) { return 1 - x / 10; }, {-10, 0});
  const BakedFlesh flesh(tissue, volume.grid, {{joint, 33}, {other, -7}});
  for (std::int64_t brick = 0; brick < std::ssize(tissue.bricks()); ++brick) {
    BakedFlesh::CornerShifts shifts;
    REQUIRE(flesh.bends(brick));
    REQUIRE(flesh.corner_shifts(brick, shifts));
    for (int at = 0; at < 729; ++at) {
      const glm::ivec3 corner = tissue.bricks()[brick].corner + glm::ivec3(at % 9, at / 9 % 9, at / 81);
      REQUIRE(shifts[at] == flesh.corner_shift(corner - 1, 255));
    }
  }
  const glm::vec3 alone = BakedFlesh(tissue, volume.grid, {{joint, 33}}).shift_at({9, 11, 13}),
                  beside = BakedFlesh(tissue, volume.grid, {{other, -7}}).shift_at({9, 11, 13});
  CHECK(glm::distance(flesh.shift_at({9, 11, 13}), alone + beside) < 1e-5f);
}

TEST_CASE("baked flesh: nodes outside the volume are refused") {
  LabelVolume small = block();
  small.grid.size = glm::ivec3(8);
  small.voxels.assign(small.grid.voxel_count(), 1);
  const TissueVoxels tissue(small);
  const auto joint = even_joint([](double x) { return x / 40; }, {0, 40, 80});
  CHECK_THROWS_AS(BakedFlesh(tissue, small.grid, {{joint, 33}}), Error);
}
