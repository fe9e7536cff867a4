// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures how thick a limb is at a joint. The sizes of finite elements are given relative to this thickness, so that a
// mouse, a hand and a man are meshed alike.
#pragma once

#include <optional>

#include "core/deform/depth.h"
#include "core/volume/grid.h"

namespace limber {

// Returns the diameter in mm of the largest ball inside the tissue whose centre is close to the joint: closer than the
// joint is to air. A joint off the limb's axis, or in the air beside the limb, is first moved towards the axis. Returns
// nothing if the nearest tissue is further away than a quarter of the grid's longest edge.
//   joint  world, mm
std::optional<double> limb_thickness(const TissueDepth& depth, const Grid& grid, const glm::dvec3& joint);

}  // namespace limber
