// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/joint_surface.h"

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

using namespace limber;

namespace {
// Returns positions 0.5 mm apart in an elliptic rod about the z axis, which is turned about z by `turn`.
std::vector<glm::dvec3> rod(double half_wide, double half_deep, double turn) {
  std::vector<glm::dvec3> places;
  for (double z = -10; z <= 10; z += 0.5)
    for (double y = -12; y <= 12; y += 0.5)
      for (double x = -12; x <= 12; x += 0.5) {
        const double a = std::cos(turn) * x + std::sin(turn) * y, b = -std::sin(turn) * x + std::cos(turn) * y;
        if (a * a / (half_wide * half_wide) + b * b / (half_deep * half_deep) < 1) places.push_back({x, y, z});
      }
  return places;
}
JointSurface of_rod(const JointShape& shape, double half_wide, double half_deep, double turn) {
  return surface_of_joint(shape, {0, 0, 0}, {0, 0, 1}, rod(half_wide, half_deep, turn), 0.125, 2.25, 20, 0.5);
}
}  // namespace

TEST_CASE("joint surface: the hinge lies along the wide side of the bones, whichever way they are turned") {
  for (const double turn : {0.0, 0.4, 1.3, 2.5}) {
    const JointSurface surface = of_rod({0, 0, -0.4, 0}, 8, 5, turn);
    CHECK(std::abs(glm::dot(surface.hinge, glm::dvec3(std::cos(turn), std::sin(turn), 0))) > 0.999);
    CHECK(surface.radius == doctest::Approx(std::sqrt(8.0 * 5.0)).epsilon(0.05));
  }
}

TEST_CASE("joint surface: a roller is straight along its hinge and falls off across it") {
  const JointSurface surface = of_rod({0.1, 0, -0.4, 0}, 8, 5, 0);
  const double r = surface.radius;
  CHECK(surface.height_of({0, 0, 0}) == doctest::Approx(-0.1 * r));
  CHECK(surface.height_of({4, 0, 0.1 * r}) == doctest::Approx(0).epsilon(1e-6));
  CHECK(surface.height_of({0, 3, 0.1 * r - 0.4 * 9 / r}) == doctest::Approx(0).epsilon(1e-6));
  CHECK(surface.height_of({0, 3, 5}) - surface.height_of({0, 3, 2}) == doctest::Approx(3));
}

TEST_CASE("joint surface: far outside the bones it falls off no more") {
  const JointSurface surface = of_rod({0, -0.3, -0.3, 0}, 6, 6, 0);
  CHECK(surface.height_of({0, 15, 0}) == doctest::Approx(surface.height_of({20, 0, 0})));
}

TEST_CASE("joint surface: round bones have no hinge, and their surface is curved alike all around") {
  const JointSurface surface = of_rod({0, 0.1, -0.5, 0}, 6, 6, 0);
  for (double angle = 0; angle < 3; angle += 0.5)
    CHECK(surface.height_of({4 * std::cos(angle), 4 * std::sin(angle), 0}) ==
          doctest::Approx(0.2 * 16 / surface.radius).epsilon(1e-6));
}

TEST_CASE("joint surface: without any bone at the joint it is still a surface") {
  const JointSurface surface = surface_of_joint({0.1, -0.2, -0.2, 0}, {1, 2, 3}, {0, 0, 1}, {}, 1, 1, 5, 0.5);
  CHECK(surface.radius == 0.5);
  CHECK(std::isfinite(surface.height_of({4, 5, 6})));
  CHECK(flat_surface({1, 2, 3}, {0, 0, 1}).height_of({7, 8, 5}) == doctest::Approx(2));
}

TEST_CASE("joint surface: names tell the shape, and a hip, a shoulder or no role has none") {
  auto shape = [](BodyPart part, int index) { return shape_of_joint(JointRole{part, BodySide::Left, index}); };
  CHECK(shape(BodyPart::Index, 1)->along_hinge < 0);  // negative: the surface is a ball
  // The little finger's second joint is a cylinder across the finger: the surface curves much less along the hinge than
  // across it.
  CHECK(shape(BodyPart::Little, 2)->across_hinge < 3 * shape(BodyPart::Little, 2)->along_hinge);
  CHECK(shape(BodyPart::Thumb, 3)->across_hinge < 0);
  CHECK(shape(BodyPart::Shank, 0).has_value());
  CHECK(!shape(BodyPart::Thigh, 0));
  CHECK(!shape(BodyPart::UpperArm, 0));
  CHECK(!shape_of_joint(std::nullopt));
}
