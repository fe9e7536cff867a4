// SPDX-License-Identifier: AGPL-3.0-or-later
// Where fitting a body may start: laid along the ways from the ends of the tissue inwards (core/rig/limb_paths.h), in every
// sense those ways leave open.
#pragma once

#include <vector>

#include "core/rig/articulated_fit.h"
#include "core/rig/surface_points.h"

namespace limber {

// Upright in the tissue's extents; and, where ends can be told for head and feet, along the limbs, facing either way.
//   body  cells of some 10 mm will do
std::vector<Mannequin> body_starts(const BodyAtlas& atlas, const Occupancy& body);

// A single limb runs from its farthest end to the other one; it may run either way, turned about itself in eight ways.
std::vector<Mannequin> limb_starts(const BodyAtlas& atlas, const Occupancy& body, AtlasKind kind);

}  // namespace limber
