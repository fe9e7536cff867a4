// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures how much air is left between the touching parts of a posed mesh's border.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace limber {

struct ContactGap {
  double smallest_mm, median_mm;
  std::int64_t nodes;  // number of nodes on both sides of the contact
};

// Returns, for each node of the border, the distance in mm to the nearest triangle in front of it that faces it and was
// at least `apart_mm` away at rest. The value is infinite if that distance is `reach_mm` or more, and for nodes inside
// the mesh.
//   rest, V  #V by 3, mm      F  #F by 3, counter-clockwise seen from outside
std::vector<double> contact_gaps(const Eigen::MatrixX3d& rest, const Eigen::MatrixX3d& V, const Eigen::MatrixX3i& F,
                                 double apart_mm, double reach_mm);

// Measures the air over all border nodes that have less than `reach_mm` of air in front of them. Returns nothing if
// there are no such nodes.
std::optional<ContactGap> contact_gap(const Eigen::MatrixX3d& rest, const Eigen::MatrixX3d& V,
                                      const Eigen::MatrixX3i& F, double apart_mm, double reach_mm);

}  // namespace limber
