// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes initial guesses for fitting a body: its limbs are laid along the paths from the ends of the tissue inwards
// (core/autorig/limb_paths.h), in all orientations that these paths leave open.
#pragma once

#include <vector>

#include "core/autorig/articulated_fit.h"
#include "core/autorig/cut_planes.h"
#include "core/mesh/surface_points.h"

namespace limber {

// Returns guesses for a whole body: one that stands upright in the tissue's extents, and two along its limbs, facing
// either way, where head and feet can be recognised among the ends. For a body that is cut off: upright in several
// sizes, aligned to the end that is present, with the arms lowered, to the side and raised.
//   body  cells of some 10 mm suffice
std::vector<Mannequin> body_starts(const BodyAtlas& atlas, const Occupancy& body, const std::vector<TissueCut>& cuts);

// Returns guesses for a single limb between the two ends of the tissue: in both directions, each rotated about its axis
// in eight steps. A limb that is cut off is also tried longer than the tissue.
std::vector<Mannequin> limb_starts(const BodyAtlas& atlas, const Occupancy& body, AtlasKind kind,
                                   const std::vector<TissueCut>& cuts);

// Returns guesses for any body, scaled to the size of the tissue: rotated by right angles, and rotated so that its
// principal axes coincide with those of the tissue.
std::vector<Mannequin> turned_starts(const BodyAtlas& atlas, const Occupancy& body);

}  // namespace limber
