// SPDX-License-Identifier: AGPL-3.0-or-later
// How much air is left between parts of a posed mesh's border that touch.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace limber {

struct ContactGap {
  double smallest_mm, median_mm;
  std::int64_t nodes;  // of the patch
};

// From each node of the border to the nearest triangle in front of it that faces it and was more than `apart_mm` away
// at rest: #V mm of air, infinite where there is no less than `reach_mm`, and inside.
//   rest, V  #V by 3, mm      F  #F by 3, counter-clockwise seen from outside
std::vector<double> contact_gaps(const Eigen::MatrixX3d& rest, const Eigen::MatrixX3d& V, const Eigen::MatrixX3i& F,
                                 double apart_mm, double reach_mm);

// The patch is all nodes with less than `reach_mm` of air. None where no node is.
std::optional<ContactGap> contact_gap(const Eigen::MatrixX3d& rest, const Eigen::MatrixX3d& V,
                                      const Eigen::MatrixX3i& F, double apart_mm, double reach_mm);

}  // namespace limber
