// SPDX-License-Identifier: AGPL-3.0-or-later
// Where fitting a body may start: laid along the ways from the ends of the tissue inwards (core/autorig/limb_paths.h),
// in every sense those ways leave open.
#pragma once

#include <vector>

#include "core/autorig/articulated_fit.h"
#include "core/autorig/cut_planes.h"
#include "core/mesh/surface_points.h"

namespace limber {

// Upright in the tissue's extents; and, where ends can be told for head and feet, along the limbs, facing either way.
// Of a body that was cut off: upright and of several sizes, with the end that is there in its place, arms lowered,
// aside and raised.
//   body  cells of some 10 mm will do
std::vector<Mannequin> body_starts(const BodyAtlas& atlas, const Occupancy& body, const std::vector<TissueCut>& cuts);

// A single limb runs from its farthest end to the other one; it may run either way, turned about itself in eight ways.
// One that was cut off may also be longer than what is there.
std::vector<Mannequin> limb_starts(const BodyAtlas& atlas, const Occupancy& body, AtlasKind kind,
                                   const std::vector<TissueCut>& cuts);

// The whole as large as the tissue, in every right angle, and turned from its own main axes to those of the tissue.
std::vector<Mannequin> turned_starts(const BodyAtlas& atlas, const Occupancy& body);

}  // namespace limber
