// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the direction in which a length is least: first among directions spread over half a sphere, then by small
// rotations of the best one.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>

#include <glm/glm.hpp>

namespace limber {

struct LeastDirection {
  glm::dvec3 direction{0, 0, 1};  // the best direction, a unit vector
  double length = std::numeric_limits<double>::infinity();
};

// Returns the direction of the least length.
//   count                  number of directions that are tried first
//   first_turn, last_turn  angle of the small rotations, radians: it starts at first_turn and is halved while it is
//                          above last_turn
//   length                 a function (unit direction, most) that returns the length, equal for opposite directions; it
//                          may return infinity if the length exceeds `most`
template <class Length>
LeastDirection least_direction(int count, double first_turn, double last_turn, const Length& length) {
  LeastDirection best;
  // Spreads the directions evenly by a spiral of the golden angle.
  for (int i = 0; i < count; ++i) {
    const double z = (i + 0.5) / count, r = std::sqrt(1 - z * z), turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const glm::dvec3 direction(r * std::cos(turn), r * std::sin(turn), z);
    if (const double found = length(direction, best.length); found < best.length) best = {direction, found};
  }
  if (best.length == std::numeric_limits<double>::infinity()) return best;
  for (double turn = first_turn; turn > last_turn; turn /= 2)
    for (bool better = true; better;) {
      better = false;
      const glm::dvec3 d = best.direction, other = std::abs(d.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
      const glm::dvec3 a = glm::normalize(glm::cross(d, other)), b = glm::cross(d, a);
      for (const glm::dvec3& way : {a, -a, b, -b}) {
        const glm::dvec3 direction = glm::normalize(best.direction + std::tan(turn) * way);
        const double found = length(direction, best.length);
        if (found < best.length * (1 - 1e-9)) best = {direction, found}, better = true;
      }
    }
  return best;
}

}  // namespace limber
