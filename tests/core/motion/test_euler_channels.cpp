// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/euler_channels.h"

#include <random>

#include <doctest/doctest.h>

#include "core/motion/key_curve.h"

namespace limber::test {

TEST_CASE("euler channels: angles give their rotation back, by matrices about the three axes") {
  std::mt19937 random(5);
  const auto angle = [&] { return (static_cast<double>(random()) / 4294967295.0 - 0.5) * 6; };
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 a(angle(), angle() / 2, angle());
    const double cx = std::cos(a.x), sx = std::sin(a.x), cy = std::cos(a.y), sy = std::sin(a.y), cz = std::cos(a.z),
                 sz = std::sin(a.z);
    const glm::dmat3 x{{1, 0, 0}, {0, cx, sx}, {0, -sx, cx}}, y{{cy, 0, -sy}, {0, 1, 0}, {sy, 0, cy}},
        z{{cz, sz, 0}, {-sz, cz, 0}, {0, 0, 1}};
    const glm::dquat q = rotation_of_channels(a);
    const glm::dmat3 wanted = z * y * x, made = glm::mat3_cast(q);
    for (int column = 0; column < 3; ++column) CHECK(glm::length(wanted[column] - made[column]) < 1e-12);
    CHECK(glm::length(channel_angles(q, a) - a) < 1e-6);
  }
}

TEST_CASE("euler channels: speeds and velocities are each other's inverse, and finite differences agree") {
  std::mt19937 random(6);
  const auto number = [&] { return static_cast<double>(random()) / 4294967295.0 - 0.5; };
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 a(6 * number(), 2.6 * number(), 6 * number()), speeds(number(), number(), number());
    const glm::dvec3 velocity = velocity_of_channels(a, speeds);
    CHECK(glm::length(channel_speeds(a, velocity) - speeds) < 1e-9);
    constexpr double kStep = 1e-6;
    const glm::dvec3 turn =
        turn_between(rotation_of_channels(a - kStep * speeds), rotation_of_channels(a + kStep * speeds));
    CHECK(glm::length(turn / (2 * kStep) - velocity) < 1e-6);
  }
  // In gimbal lock the speeds remain finite.
  const glm::dvec3 locked = channel_speeds({0.3, glm::radians(90.0), 0.2}, {1, 2, 3});
  CHECK(glm::length(locked) < 10);
}

}  // namespace limber::test
