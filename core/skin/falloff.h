// SPDX-License-Identifier: AGPL-3.0-or-later
// The falloff curve of a brush: its strength as a function of the distance, from the brush centre (1) to the rim (0).
// The curve is stored as a table.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <glm/glm.hpp>

namespace limber {

enum class FalloffShape { Smooth, Sphere, Root, Sharp, Linear, Constant };

class Falloff {
 public:
  Falloff(FalloffShape shape = FalloffShape::Smooth);
  // Makes a curve through points. The x of a point is a distance as a share of the brush radius, its y the strength
  // there; both are in [0, 1], and the distances ascend. Between the points the curve is smooth and does not overshoot
  // [Fritsch & Carlson 1980]. It is constant before the first point and behind the last. At least one point is needed.
  explicit Falloff(std::span<const glm::dvec2> points);

  // Returns the strength at a distance from the centre.
  //   share  the distance as a share of the radius, [0, 1]
  float operator()(float share) const {
    const float at = share * kSteps;
    const int step = at < kSteps - 1 ? static_cast<int>(at) : kSteps - 1;
    return table_[step] + (at - static_cast<float>(step)) * (table_[step + 1] - table_[step]);
  }
  // Computes the brush strength at many distances from the centre: `strength` times the falloff at distance *
  // per_radius. If distance * per_radius is 1 or more, the falloff at the rim is used. The results are in units of
  // 1/65535.
  //   distance, covers  #count each
  void covers(const float* distance, int count, float per_radius, float strength, std::uint16_t* covers) const;
  bool operator==(const Falloff&) const = default;

 private:
  static constexpr int kSteps = 256;
  std::array<float, kSteps + 1> table_;
};

}  // namespace limber
