// SPDX-License-Identifier: AGPL-3.0-or-later
// How a brush fades from its centre (1) to its rim (0).
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
  // A curve through points (distance as a share of the radius, cover), both [0, 1], distances growing; smooth between
  // points without overshooting [Fritsch & Carlson 1980], level before the first and after the last. At least one
  // point.
  explicit Falloff(std::span<const glm::dvec2> points);

  // share [0, 1] of the radius
  float operator()(float share) const {
    const float at = share * kSteps;
    const int step = at < kSteps - 1 ? static_cast<int>(at) : kSteps - 1;
    return table_[step] + (at - static_cast<float>(step)) * (table_[step + 1] - table_[step]);
  }
  // Of many distances at once: strength times the falloff of distance * per_radius (1 and more: the rim), in 1/65535,
  // rounded.
  //   distance, covers  #count each
  void covers(const float* distance, int count, float per_radius, float strength, std::uint16_t* covers) const;
  bool operator==(const Falloff&) const = default;

 private:
  static constexpr int kSteps = 256;
  std::array<float, kSteps + 1> table_;
};

}  // namespace limber
