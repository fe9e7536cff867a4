// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/repair/turn_table.h"

#include <algorithm>
#include <array>

namespace limber {

TurnTable::TurnTable(Blend blend, double angle) : rows_(kSteps + 1) {
  const std::array<SkinTransform, 2> bones{
      skin_transform(RigidTransform{}), skin_transform(RigidTransform{glm::angleAxis(angle, glm::dvec3(0, 0, 1)), {}})};
  const auto moved = [&](double w) {
    const std::array<BoneWeight, 2> influences{{{0, 1 - w}, {1, w}}};
    const glm::dvec3 p = blend_point(blend, bones, influences, {1, 0, 0});
    return std::complex<double>(p.x, p.y);
  };
  constexpr double kDifference = 1e-4;
  for (int i = 0; i <= kSteps; ++i) {
    const double w = double(i) / kSteps, low = std::max(0.0, w - kDifference), high = std::min(1.0, w + kDifference);
    const std::complex<double> z = moved(w), slope = (moved(high) - moved(low)) / (high - low),
                               k = std::conj(z) * slope;
    rows_[i] = {static_cast<float>(std::norm(z)), static_cast<float>(k.real()), static_cast<float>(k.imag()),
                static_cast<float>(std::arg(z))};
  }
}

std::pair<double, double> TurnTable::angle_at(double w) const {
  const double place = std::clamp(w, 0.0, 1.0) * kSteps;
  const int i = std::min(static_cast<int>(place), kSteps - 1);
  const double t = place - i, rise = rows_[i + 1].angle - rows_[i].angle;
  return {rows_[i].angle + t * rise, rise * kSteps};
}

}  // namespace limber
