// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes initial guesses of a body's pose. The body's limbs are moved onto the paths that lead inwards from the ends of
// the tissue (tips of head, hands and feet; core/autorig/limb_paths.h), in all orientations that the paths allow.
#pragma once

#include <vector>

#include "core/autorig/articulated_fit.h"
#include "core/autorig/cut_planes.h"
#include "core/mesh/surface_points.h"

namespace limber {

// Returns guesses for a whole body. The first one stands upright in the tissue's extents. If head and feet can be
// recognised among the tissue's ends, two more guesses have their limbs on the paths, one facing each way. For a body
// that is cut off, more guesses stand upright in several sizes, aligned to the end that is present, with the arms
// lowered, to the side and raised.
//   body  cells of about 10 mm are fine enough
std::vector<Mannequin> body_starts(const BodyAtlas& atlas, const Occupancy& body, const std::vector<TissueCut>& cuts);

// Returns guesses for a single limb between the two ends of the tissue: in both directions, each rotated about the
// limb's axis in eight steps. A limb that is cut off is also tried in an adult's size, longer than the tissue.
std::vector<Mannequin> limb_starts(const BodyAtlas& atlas, const Occupancy& body, AtlasKind kind,
                                   const std::vector<TissueCut>& cuts);

// Returns guesses for any body, scaled to the size of the tissue. Some guesses are rotated by right angles; in the
// others, the body's principal axes coincide with the tissue's.
std::vector<Mannequin> turned_starts(const BodyAtlas& atlas, const Occupancy& body);

}  // namespace limber
