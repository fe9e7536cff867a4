// SPDX-License-Identifier: AGPL-3.0-or-later
// Distances, angles, girths and thicknesses of a body. A measurement is stored as points of the body at rest, so that
// it stays on the tissue: in a pose, its points move with the tissue around them (resample/posed_points.h) and are
// measured there.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace limber {

enum class MeasureKind : std::uint8_t {
  Distance,   // between two points, mm
  Angle,      // of three points, at the second one
  Girth,      // length of a closed tape whose corners are the points
  Thickness,  // of a tissue: distance between two points on its borders
};
constexpr int kMeasureKinds = 4;

struct Measurement {
  std::string name;  // unique among the document's measurements
  MeasureKind kind = MeasureKind::Distance;
  std::vector<glm::dvec3> points;  // positions on the body at rest, world, mm

  bool operator==(const Measurement&) const = default;
};
using Measurements = std::vector<Measurement>;

// Returns the word for a kind: "distance", "angle", "girth" or "thickness".
std::string_view word_of(MeasureKind kind);

// Returns whether a measurement of this kind can have this number of points. A girth has 3 to kMostTapeCorners points.
constexpr std::size_t kMostTapeCorners = 4096;
bool is_complete(MeasureKind kind, std::size_t points);

// Returns the value for the points at rest or in a pose, mm or degrees.
double measure(MeasureKind kind, std::span<const glm::dvec3> points);

// Returns a measured value with its unit, such as "123.4 mm" or "61.2\u00b0".
std::string text_of_measure(MeasureKind kind, double value);

}  // namespace limber
