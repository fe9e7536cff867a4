// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/limb_bend.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/gtc/quaternion.hpp>

namespace limber {

double bend_for(const glm::dvec3& upper, const glm::dvec3& lower, const glm::dvec3& axis, double wanted) {
  // If `angle` is the rotation of the lower bone about the axis, then dot(upper, turned lower) = across + a cos(angle)
  // + b sin(angle).
  const double across = glm::dot(upper, axis) * glm::dot(axis, lower);
  const double a = glm::dot(upper, lower) - across, b = glm::dot(upper, glm::cross(axis, lower));
  const double c = (wanted * wanted - glm::dot(upper, upper) - glm::dot(lower, lower)) / 2 - across;
  const double most = std::hypot(a, b);
  if (most == 0) return 0;
  const double middle = std::atan2(b, a), half = std::acos(std::clamp(c / most, -1.0, 1.0));
  const auto bends = [&](double angle) {
    return glm::dot(axis, glm::cross(upper, glm::angleAxis(angle, axis) * lower)) >= 0;
  };
  return std::remainder(bends(middle + half) ? middle + half : middle - half, 2 * std::numbers::pi);
}

}  // namespace limber
