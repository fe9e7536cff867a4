// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/baked_joint.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace limber {

namespace {

// The slope at x[at] of the parabola through the values at three neighbouring angles is a weighted sum of these values.
// Adds the weights of this sum, multiplied by `factor`, to `shares`. If there are only two angles, uses the slope of
// the line through them.
void add_slope(const std::vector<double>& x, int at, double factor, std::vector<double>& shares) {
  const int last = static_cast<int>(x.size()) - 1;
  if (last == 1) {
    shares[0] -= factor / (x[1] - x[0]);
    shares[1] += factor / (x[1] - x[0]);
    return;
  }
  const int middle = std::clamp(at, 1, last - 1);
  const int three[3] = {middle - 1, middle, middle + 1};
  for (int i = 0; i < 3; ++i) {
    // The derivative of the Lagrange polynomial that is 1 at this angle and 0 at the other two.
    const int j = three[(i + 1) % 3], k = three[(i + 2) % 3], own = three[i];
    shares[own] += factor * (2 * x[at] - x[j] - x[k]) / ((x[own] - x[j]) * (x[own] - x[k]));
  }
}

}  // namespace

BakeError worst_between(const BakedJoint& joint) {
  BakeError worst;
  double most = 0;
  for (const BakeError& error : joint.between) {
    if (const double larger = std::max(error.flesh_mm, error.skin_mm); larger > most)
      most = larger, worst.degrees = error.degrees;
    worst.flesh_mm = std::max(worst.flesh_mm, error.flesh_mm);
    worst.skin_mm = std::max(worst.skin_mm, error.skin_mm);
    worst.largest_mm = std::max(worst.largest_mm, error.largest_mm);
  }
  return worst;
}

TurnAboutAxis turn_about_axis(const glm::dquat& turn, const glm::dvec3& axis) {
  const double along = glm::dot(glm::dvec3(turn.x, turn.y, turn.z), axis);
  double degrees = glm::degrees(2 * std::atan2(along, turn.w));
  if (degrees > 180) degrees -= 360;
  if (degrees <= -180) degrees += 360;
  // The remaining rotation is about an axis perpendicular to `axis`.
  const double about = std::min(1.0, std::hypot(along, turn.w));
  return {degrees, glm::degrees(2 * std::acos(about))};
}

std::vector<std::pair<int, double>> shares_at(const std::vector<double>& degrees, double angle) {
  const int count = static_cast<int>(degrees.size());
  std::vector<double> shares(count, 0.0);
  if (count == 1 || angle <= degrees.front()) shares.front() = 1;
  else if (angle >= degrees.back()) shares.back() = 1;
  else {
    const int high = static_cast<int>(std::upper_bound(degrees.begin(), degrees.end(), angle) - degrees.begin());
    const int low = high - 1;
    const double length = degrees[high] - degrees[low], t = (angle - degrees[low]) / length;
    shares[low] += 1 - t * t * (3 - 2 * t);
    shares[high] += t * t * (3 - 2 * t);
    add_slope(degrees, low, length * t * (1 - t) * (1 - t), shares);
    add_slope(degrees, high, -length * t * t * (1 - t), shares);
  }
  std::vector<std::pair<int, double>> given;
  for (int i = 0; i < count; ++i)
    if (shares[i] != 0 && degrees[i] != 0) given.emplace_back(i, shares[i]);
  return given;
}

}  // namespace limber
