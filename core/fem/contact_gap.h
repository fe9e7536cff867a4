// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures how much air is left between parts of a posed mesh's border that touch or nearly touch each other.
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

// Returns for each node of the border the distance in mm to the nearest opposite triangle: one that lies in front of
// the node, faces the node and was at least `apart_mm` away at rest. The value is infinite for distances of `reach_mm`
// or more, and for nodes inside the mesh.
//   rest, V  #V by 3, mm      F  #F by 3, counter-clockwise seen from outside
std::vector<double> contact_gaps(const Eigen::MatrixX3d& rest, const Eigen::MatrixX3d& V, const Eigen::MatrixX3i& F,
                                 double apart_mm, double reach_mm);

// Returns the least and the median gap (contact_gaps()) of the border nodes whose gap is less than `reach_mm`. Returns
// nothing if no node has such a gap.
std::optional<ContactGap> contact_gap(const Eigen::MatrixX3d& rest, const Eigen::MatrixX3d& V,
                                      const Eigen::MatrixX3i& F, double apart_mm, double reach_mm);

}  // namespace limber
