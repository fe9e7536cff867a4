// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/falloff.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace limber {

namespace {

double cover(FalloffShape shape, double share) {
  const double left = 1 - share;
  switch (shape) {
    case FalloffShape::Smooth: return left * left * (3 - 2 * left);
    case FalloffShape::Sphere: return std::sqrt(std::max(0.0, 1 - share * share));
    case FalloffShape::Root: return std::sqrt(left);
    case FalloffShape::Sharp: return left * left;
    case FalloffShape::Linear: return left;
    case FalloffShape::Constant: return 1;
  }
  return 0;
}

// Returns the slope of the falloff curve at each point. With these slopes the curve is monotone between the points
// [Fritsch & Carlson 1980].
std::vector<double> slopes(std::span<const glm::dvec2> points) {
  const std::size_t count = points.size();
  std::vector<double> slope(count), secant(count > 0 ? count - 1 : 0);
  for (std::size_t i = 0; i + 1 < count; ++i)
    secant[i] = (points[i + 1].y - points[i].y) / (points[i + 1].x - points[i].x);
  for (std::size_t i = 1; i + 1 < count; ++i)
    slope[i] = secant[i - 1] * secant[i] <= 0 ? 0 : (secant[i - 1] + secant[i]) / 2;
  if (count > 1) slope[0] = secant[0], slope[count - 1] = secant[count - 2];
  for (std::size_t i = 0; i + 1 < count; ++i) {
    if (secant[i] == 0) {
      slope[i] = slope[i + 1] = 0;
      continue;
    }
    const double a = slope[i] / secant[i], b = slope[i + 1] / secant[i], length = std::sqrt(a * a + b * b);
    if (length > 3) slope[i] *= 3 / length, slope[i + 1] *= 3 / length;
  }
  return slope;
}

void find_covers(const float* table, int steps, const float* distance, int count, float per_radius, float strength,
                 std::uint16_t* covers) {
  for (int i = 0; i < count; ++i) {
    const float share = std::min(distance[i] * per_radius, 1.0f), at = share * static_cast<float>(steps);
    const int step = std::min(static_cast<int>(at), steps - 1);
    const float cover = table[step] + (at - static_cast<float>(step)) * (table[step + 1] - table[step]);
    covers[i] = static_cast<std::uint16_t>(static_cast<int>(strength * cover * 65535 + 0.5f));
  }
}

}  // namespace

Falloff::Falloff(FalloffShape shape) {
  for (int i = 0; i <= kSteps; ++i) table_[i] = static_cast<float>(cover(shape, double(i) / kSteps));
}

Falloff::Falloff(std::span<const glm::dvec2> points) {
  if (points.empty()) throw std::logic_error("Falloff: the curve has no points");
  for (std::size_t i = 1; i < points.size(); ++i)
    if (!(points[i].x > points[i - 1].x))
      throw std::logic_error("Falloff: distances must increase from point to point");
  const std::vector<double> slope = slopes(points);
  for (int i = 0; i <= kSteps; ++i) {
    const double x = double(i) / kSteps;
    std::size_t after = 0;
    while (after < points.size() && points[after].x <= x) ++after;
    double y;
    if (after == 0) {
      y = points.front().y;
    } else if (after == points.size()) {
      y = points.back().y;
    } else {
      const glm::dvec2 &a = points[after - 1], &b = points[after];
      const double h = b.x - a.x, t = (x - a.x) / h, u = 1 - t;
      y = a.y * u * u * (1 + 2 * t) + b.y * t * t * (3 - 2 * t) +
          h * (slope[after - 1] * t * u * u - slope[after] * t * t * u);
    }
    table_[i] = static_cast<float>(std::clamp(y, 0.0, 1.0));
  }
}

void Falloff::covers(const float* distance, int count, float per_radius, float strength, std::uint16_t* covers) const {
  find_covers(table_.data(), kSteps, distance, count, per_radius, strength, covers);
}

}  // namespace limber
