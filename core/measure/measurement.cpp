// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/measure/measurement.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace limber {

std::string_view word_of(MeasureKind kind) {
  constexpr std::array<std::string_view, kMeasureKinds> kWords{"distance", "angle", "girth", "thickness"};
  return kWords[static_cast<std::size_t>(kind)];
}

bool is_complete(MeasureKind kind, std::size_t points) {
  switch (kind) {
    case MeasureKind::Angle: return points == 3;
    case MeasureKind::Girth: return points >= 3 && points <= kMostTapeCorners;
    default: return points == 2;
  }
}

double measure(MeasureKind kind, std::span<const glm::dvec3> points) {
  if (kind == MeasureKind::Angle) {
    const glm::dvec3 a = points[0] - points[1], b = points[2] - points[1];
    // Uses atan2, since acos is inaccurate near 0 and 180 degrees.
    return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
  }
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += glm::distance(points[i - 1], points[i]);
  if (kind == MeasureKind::Girth) length += glm::distance(points.back(), points.front());
  return length;
}

std::string text_of_measure(MeasureKind kind, double value) {
  char text[48];
  std::snprintf(text, sizeof text, kind == MeasureKind::Angle ? "%.1f\u00b0" : "%.1f mm", value);
  return text;
}

}  // namespace limber
