// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/dual_quaternion.h"

#include <numbers>

#include <doctest/doctest.h>

using namespace limber;

TEST_CASE("screw: who follows its velocity for one unit of time ends where the transform takes him") {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1, -2, 0.5));
  for (const double angle : {0.0, 1e-9, 1e-4, 1.1e-3, 0.3, 1.7, std::numbers::pi - 1e-3}) {
    CAPTURE(angle);
    for (const double sign : {1.0, -1.0}) {
      const RigidTransform transform{sign * glm::angleAxis(angle, axis), {30, -4, 12}};
      const Screw screw = screw_of(transform);
      CHECK(glm::length(screw.turn - angle * axis) < 1e-6);
      glm::dvec3 p(7, 50, -20);
      const glm::dvec3 there = transform * p;
      constexpr int kSteps = 1000;  // steps of the fourth-order Runge-Kutta method
      for (int k = 0; k < kSteps; ++k) {
        const double h = 1.0 / kSteps;
        const glm::dvec3 a = screw.velocity(p), b = screw.velocity(p + 0.5 * h * a),
                         c = screw.velocity(p + 0.5 * h * b), d = screw.velocity(p + h * c);
        p += h / 6 * (a + 2.0 * b + 2.0 * c + d);
      }
      CHECK(glm::distance(p, there) < 1e-7);
    }
  }
}
